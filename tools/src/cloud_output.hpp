// Where the points of a 3D map go: thinned, floor and ceiling taken out where that is asked for, into a file. Memory
// does not grow with the cloud; what has to be seen as a whole goes through a spool file. One object, one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/mapping/option.hpp"

namespace gdtslam {

enum class CloudRemoval : std::uint8_t { kNone, kFloor, kCeiling, kBoth };

struct CloudConfig {
  double voxel_m = 0.02;             ///< one point a voxel; 0 keeps all
  std::int32_t max_megavoxels = 64;  ///< memory: 16 to 32 MiB each
  CloudRemoval remove = CloudRemoval::kNone;
  double remove_margin_m = 0.05;  ///< over the floor and under the ceiling
};
/// The table of the options, under "cloud."; its rows point into `config`.
std::vector<Option> options_of(CloudConfig& config);

/// What became of the points.
struct CloudSummary {
  std::uint64_t measured = 0;  ///< points that came
  std::uint64_t thinned = 0;   ///< left by thinning
  double voxel_m = 0.0;        ///< of the thinning at the end: larger than asked for where its memory was full
  std::uint64_t removed = 0;   ///< as floor or ceiling
  std::uint64_t written = 0;
  std::string sha256;  ///< of the points as written
  LevelSurfaces surfaces;
};

class CloudOutput : public CloudSink {
 public:
  /// Writes to `path`; a spool file beside it is gone when this is. Throws FileError, as add() and finish() do.
  CloudOutput(const CloudConfig& config, std::string path);
  ~CloudOutput() override;
  void add(std::span<const CloudPoint> points) override;
  CloudSummary finish();
  [[nodiscard]] const CloudConfig& config() const { return config_; }

 private:
  void coarsen();

  CloudConfig config_;
  std::string path_;
  std::string spool_;  ///< empty: points go straight into the file
  std::unique_ptr<CloudWriter> writer_;
  std::unique_ptr<VoxelThinning> thinning_;
  CloudSummary summary_;
};

}  // namespace gdtslam
