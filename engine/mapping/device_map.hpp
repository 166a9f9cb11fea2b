// The map and its matcher on a device that may fail. When it does, both move to a CPU backend of their own, with the
// map as the host knows it, and what was being done is done again there; or, without leave to fall back, the map stays
// on the host and the error goes to the caller. The device is asked for nothing after its first error. Not thread-safe.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/mapping/map/local_field.hpp"
#include "engine/mapping/match/matcher.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/global_field.hpp"
#include "gdtslam/mapping/mapper.hpp"

namespace gdtslam {

class DeviceMap {
 public:
  DeviceMap(const MapperConfig& config, Backend& backend, MapperOptions options);

  /// Throws the DeviceError that ended the work, if there was one and no leave to fall back.
  void require_device() const;
  /// Matcher::start() and finish(); the points must live until finish_match() has returned.
  void start_match(std::span<const PointCells> points, const Prediction& prediction, bool search);
  MatchResult finish_match();
  /// Sets the device to work on the keyframe and returns. After InputError nothing has changed; after DeviceError the
  /// keyframe is in the map all the same.
  void merge(const KeyframeCells& keyframe, StageTimes& stages);

  [[nodiscard]] const GlobalField& field() const { return field_; }
  std::vector<std::uint16_t> download_device_cells();
  /// Text of the error of the device; empty while it works.
  [[nodiscard]] const std::string& loss() const { return loss_text_; }
  void count_work(MapperStatistics& statistics) const;

 private:
  void work_on(Backend& backend);
  void fall_back(const DeviceError& error);
  void add_keyframe(const KeyframeCells& keyframe);
  void merge_on_device(const KeyframeCells& keyframe, StageTimes& stages);

  MapperConfig config_;
  MapperOptions options_;
  MergeStep step_;
  Backend* backend_ = nullptr;        // null when it failed and the caller wants no other
  std::unique_ptr<Backend> own_cpu_;  // destroyed after all that has memory there
  GlobalField field_;
  std::optional<LocalField> local_;
  std::unique_ptr<Matcher> matcher_;

  // The scan in hand, should it have to be matched again.
  std::span<const PointCells> points_;
  Prediction prediction_;
  bool search_ = false;

  std::optional<DeviceError> loss_;
  std::string loss_text_;
  // What backends counted for this mapper that it no longer uses, less what this one had counted before.
  std::uint64_t earlier_dispatches_ = 0;
  std::uint64_t earlier_submissions_ = 0;
};

}  // namespace gdtslam
