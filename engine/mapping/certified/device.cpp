#include "device.hpp"

#include <algorithm>

#include "engine/compute/device_memory.hpp"

namespace gdtslam {

DeviceBounds::DeviceBounds(Backend& backend, const BoundFields& fields)
    : backend_(backend), fields_(fields), samples_(fields.levels().size()) {}

// A window beyond the limits of a launch lies off any map; the host handles it by clamping.
bool DeviceBounds::takes(const PoseBounds::Params& params, std::size_t level, std::size_t tiles) const {
  const std::uint64_t boxes = std::uint64_t{params.tile_width} * params.tile_height * tiles;
  const std::size_t most = std::max({fields_.levels()[level].samples.size(), boxes * sizeof(std::uint32_t),
                                     tiles * sizeof(PoseCandidate), params.point_count * sizeof(BoundPoint)});
  const auto in_reach = [](std::int32_t first) {
    return -PoseBounds::kFarthestFirst <= first && first <= PoseBounds::kFarthestFirst;
  };
  return boxes * params.point_count >= kLeastLookUps && in_reach(params.first_column) && in_reach(params.first_row) &&
         most <= backend_.device().max_buffer_bytes;
}

void DeviceBounds::sum(const PoseBounds::Params& params, std::size_t level, std::span<const BoundPoint> points,
                       std::span<const PoseCandidate> tiles, std::span<std::uint32_t> sums) {
  const std::lock_guard lock(mutex_);
  Buffer& samples = samples_[level];
  if (!samples.valid()) {
    const auto bytes = std::as_bytes(std::span(fields_.levels()[level].samples));
    Buffer uploaded = backend_.allocate(bytes.size());
    backend_.upload(uploaded, bytes);
    samples = std::move(uploaded);
  }
  reserve_on(backend_, points_, points.size_bytes());
  reserve_on(backend_, tiles_, tiles.size_bytes());
  reserve_on(backend_, sums_, sums.size_bytes());
  backend_.upload(points_, std::as_bytes(points));
  backend_.upload(tiles_, std::as_bytes(tiles));
  run<PoseBounds>(backend_, params, {static_cast<std::uint32_t>(tiles.size()), 1, 1}, samples, points_, tiles_, sums_);
  backend_.download(sums_, std::as_writable_bytes(sums));
  ++launches_;
}

}  // namespace gdtslam
