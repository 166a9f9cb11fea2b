// Writes the points of a 3D map to a file: thinned, and on request without floor and ceiling. Memory does not grow with
// the cloud; points that must be seen as a whole go through a spool file. One object, one thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/cloud/thinning.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/runs/outcome.hpp"
#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

class CloudOutput : public CloudSink {
 public:
  /// Writes to `path`; the destructor removes the spool file beside it. Throws FileError, as add() and finish() do.
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
