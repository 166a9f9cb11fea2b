#include "keyframe_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "store/field_store.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kLongJournal = 64;  // keyframes: a moment's work to replay
constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;

MergeStep merge_step(const MapperConfig& config) {
  const double threshold = config.merge.threshold_m / config.map.resolution_m * kFieldOne;
  return {.rule = config.merge.rule,
          .threshold = static_cast<std::uint32_t>(std::lround(threshold)),
          .lift = static_cast<std::uint32_t>(std::lround(threshold * config.merge.kappa))};
}

}  // namespace

KeyframeMap::KeyframeMap(const MapperConfig& config, Backend& backend)
    : field(backend, config.map.resolution_m, config.map.radius_cells(),
            static_cast<std::uint64_t>(config.map.max_megacells) << 20U),
      local(backend, config.map.radius_cells(), config.map.transform),
      step(merge_step(config)) {}

void KeyframeMap::merge(const KeyframeCells& keyframe, StageTimes& stages, RoomLimit limit) {
  {
    const StageTimer timer(stages.local_field_s);
    field.grow_to_hold(keyframe.window);
    local.prepare(keyframe, field, limit);
  }
  const StageTimer timer(stages.merge_s);
  local.merge_into(field, step);
}

void DeviceMap::merge(StageTimes& stages) {
  try {
    map_.merge(journal_.back(), stages);
  } catch (const InputError&) {
    journal_.pop_back();
    throw;
  }
  const StageTimer timer(stages.merge_s);
  continue_checkpoint();
  map_.field.backend().flush();
}

// The CPU counts whole tiles, and so more than the device at times; but what the device has is the map.
void DeviceMap::update_host() {
  StageTimes not_counted;
  for (; !journal_.empty(); journal_.pop_front(), ++held_) {
    host_.merge(journal_.front(), not_counted, RoomLimit::kIgnored);
  }
}

void DeviceMap::continue_checkpoint() {
  const GlobalField& field = map_.field;
  if (!checkpoint_ && journal_.size() >= kLongJournal) {
    const std::size_t cells = std::size_t{field.snapshot_stride()} * static_cast<std::size_t>(field.box().height());
    checkpoint_ = Checkpoint{.snapshot = field.snapshot(),
                             .box = field.box(),
                             .stride = field.snapshot_stride(),
                             .keyframes = held_ + journal_.size(),
                             .cells = std::vector<std::uint16_t>(cells),
                             .under_way = {}};
  }
  if (!checkpoint_ || checkpoint_->under_way) return;
  Checkpoint& c = *checkpoint_;
  const std::size_t bytes = std::min(kPieceBytes, (c.cells.size() - c.arrived) * sizeof(std::uint16_t));
  c.under_way = field.backend().start_download(c.snapshot, bytes, c.arrived * sizeof(std::uint16_t));
}

void DeviceMap::take_checkpoint_piece() {
  if (!checkpoint_ || !checkpoint_->under_way) return;
  Checkpoint& c = *checkpoint_;
  const PendingDownload piece = *std::exchange(c.under_way, std::nullopt);
  const std::size_t cells = piece.bytes / sizeof(std::uint16_t);
  map_.field.backend().finish_download(piece, std::as_writable_bytes(std::span(c.cells).subspan(c.arrived, cells)));
  c.arrived += cells;
  if (c.arrived < c.cells.size()) return;
  if (c.keyframes > held_) {
    for (; held_ < c.keyframes; ++held_) journal_.pop_front();
    host_.field.adopt({c.cells, c.stride, c.box});
  }
  checkpoint_.reset();
}

}  // namespace gdtslam
