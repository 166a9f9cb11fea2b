// The map on the backend where its matcher works: keyframes are merged there (KeyframeMap). Where that is not the CPU,
// the CPU keeps a map that is brought up to date from a journal when it is asked for (DeviceMap): every keyframe is
// written there before the device is asked for anything, so that what a lost device took along is known, and the CPU's
// kernels make the same bits of it. Not thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "gdtslam/mapping/mapper.hpp"
#include "local_field.hpp"

namespace gdtslam {

struct KeyframeMap {
  KeyframeMap(const MapperConfig& config, Backend& backend);
  /// Paper equation (1), and (9) to (11); grows the map where it has to. Throws InputError where the map would become
  /// too large; its cells are as before then.
  void merge(const KeyframeCells& keyframe, StageTimes& stages, RoomLimit limit = RoomLimit::kHeeded);

  GlobalField field;
  LocalField local;
  MergeStep step;
};

class DeviceMap {
 public:
  /// `host` is the map on the CPU, empty as yet; it must outlive this and hold the keyframes' windows.
  DeviceMap(const MapperConfig& config, Backend& device, KeyframeMap& host) : map_(config, device), host_(host) {}

  [[nodiscard]] const GlobalField& field() const { return map_.field; }
  /// Notes a keyframe for the CPU. Asks the device for nothing.
  void note(const KeyframeCells& keyframe) { journal_.push_back(keyframe); }
  /// Sets the device to work on the keyframe that was noted, and returns. Throws InputError where the device's map
  /// would become too large; then the keyframe is noted no more, so that the CPU's map does not get it either.
  void merge(StageTimes& stages);
  /// Brings the map on the CPU up to date. Asks the device for nothing, and refuses no keyframe that it took.
  void update_host();
  /// Keyframes that the map on the CPU does not hold yet.
  [[nodiscard]] std::size_t journal_length() const { return journal_.size(); }

  /// Where the journal has become long, merge() copies the field on the device, and asks for one piece of the copy
  /// after the other, behind the work in line; each is small, so that it needs no submission of its own. This takes the
  /// piece that was asked for, if one was; after the last the journal forgets the keyframes that the copy holds.
  void take_checkpoint_piece();

 private:
  // A state of the field on its way to the host.
  struct Checkpoint {
    Buffer snapshot;
    CellBox box;
    std::uint32_t stride = 0;     // of its rows
    std::uint64_t keyframes = 0;  // that it holds
    std::vector<std::uint16_t> cells;
    std::size_t arrived = 0;  // cells
    std::optional<PendingDownload> under_way;
  };
  void continue_checkpoint();

  KeyframeMap map_;
  KeyframeMap& host_;
  std::uint64_t held_ = 0;  // keyframes that the map on the CPU holds
  std::deque<KeyframeCells> journal_;
  std::optional<Checkpoint> checkpoint_;
};

/// Adds the time until the end of its scope to a stage.
class StageTimer {
 public:
  explicit StageTimer(double& seconds) : seconds_(&seconds), start_(Clock::now()) {}
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer() { *seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double* seconds_;
  Clock::time_point start_;
};

}  // namespace gdtslam
