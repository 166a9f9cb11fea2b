#include "device_map.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/mapping/map/stage_timer.hpp"
#include "engine/mapping/match/matchers.hpp"

namespace gdtslam {
namespace {

MergeStep merge_step_of(const MapperConfig& config) {
  const double threshold = config.merge.threshold_m / config.map.resolution_m * kFieldOne;
  return {.rule = config.merge.rule,
          .threshold = static_cast<std::uint32_t>(std::lround(threshold)),
          .lift = static_cast<std::uint32_t>(std::lround(threshold * config.merge.kappa))};
}

}  // namespace

DeviceMap::DeviceMap(const MapperConfig& config, Backend& backend, MapperOptions options)
    : config_(config),
      options_(std::move(options)),
      step_(merge_step_of(config)),
      field_(backend, config.map.resolution_m, config.map.radius_cells(),
             static_cast<std::uint64_t>(config.map.max_megacells) << 20U, config.map.transform) {
  try {
    work_on(backend);
  } catch (const DeviceError& error) {
    fall_back(error);
  }
}

void DeviceMap::work_on(Backend& backend) {
  backend_ = &backend;
  earlier_dispatches_ -= backend.dispatch_count();
  earlier_submissions_ -= backend.submit_count();
  matcher_.reset();
  local_.emplace(backend, config_.map.radius_cells(), config_.map.transform);
  matcher_ = matcher_info(config_.match.matcher).make(config_, backend, field_);
}

void DeviceMap::require_device() const {
  if (backend_ == nullptr) throw DeviceError(*loss_);
}

// Memory that the host shares is no copy: what a failed dispatch left in it cannot be known, and there is no way back.
void DeviceMap::fall_back(const DeviceError& error) {
  earlier_dispatches_ += backend_->dispatch_count();
  earlier_submissions_ += backend_->submit_count();
  loss_ = error;
  loss_text_ = error.what();
  backend_ = nullptr;
  matcher_.reset();
  local_.reset();
  if (!options_.fall_back || field_.shares_memory()) {
    if (!field_.shares_memory()) field_.leave_device();
    throw DeviceError(error);
  }
  own_cpu_ = make_cpu_backend(options_.cpu);
  field_.move_to(*own_cpu_);
  work_on(*own_cpu_);
  if (options_.warn) options_.warn(loss_text_ + "; going on with the CPU, which gives the same results");
}

void DeviceMap::start_match(std::span<const PointCells> points, const Prediction& prediction, bool search) {
  points_ = points;
  prediction_ = prediction;
  search_ = search;
  try {
    matcher_->start(points_, prediction_, search_);
    return;
  } catch (const DeviceError& error) {
    fall_back(error);
  }
  matcher_->start(points_, prediction_, search_);
}

MatchResult DeviceMap::finish_match() {
  try {
    const MatchResult result = matcher_->finish();
    field_.take_checkpoint_piece();  // it stood in line before this scan, so it is there
    return result;
  } catch (const DeviceError& error) {
    fall_back(error);
  }
  return matcher_->match(points_, prediction_, search_);
}

void DeviceMap::merge(const KeyframeCells& keyframe, StageTimes& stages) {
  try {
    merge_on_device(keyframe, stages);
  } catch (const DeviceError& error) {
    fall_back(error);  // the keyframe is in the journal, and so in the map that the CPU gets
  }
}

void DeviceMap::merge_on_device(const KeyframeCells& keyframe, StageTimes& stages) {
  {
    const StageTimer timer(stages.local_field_s);
    add_keyframe(keyframe);
    local_->compute(keyframe);
  }
  const StageTimer timer(stages.merge_s);
  local_->merge_into(field_, step_);
  field_.continue_checkpoint();
  backend_->flush();
}

// Where the map has outgrown the device, the error says so, and what to change.
void DeviceMap::add_keyframe(const KeyframeCells& keyframe) {
  try {
    field_.add_keyframe(keyframe, step_);
  } catch (const DeviceError& error) {
    const DeviceInfo& device = backend_->device();
    const GridGeometry grid = field_.geometry();
    const std::size_t cells = std::size_t{field_.stride()} * static_cast<std::size_t>(grid.height);
    const std::size_t most = device.max_buffer_bytes / sizeof(std::uint16_t);
    if (cells <= most) throw;
    const std::string size = std::to_string(grid.width) + " x " + std::to_string(grid.height);
    throw DeviceError(device.name, error.call(),
                      error.result() + ", for the map of " + size +
                          " cells; a larger map.resolution makes it smaller, map.max_megacells=" +
                          std::to_string(most >> 20U) + " bounds it to that");
  }
}

std::vector<std::uint16_t> DeviceMap::download_device_cells() {
  require_device();
  return field_.download_device_cells();
}

void DeviceMap::count_work(MapperStatistics& statistics) const {
  statistics.dispatches = earlier_dispatches_ + (backend_ != nullptr ? backend_->dispatch_count() : 0);
  statistics.submissions = earlier_submissions_ + (backend_ != nullptr ? backend_->submit_count() : 0);
}

}  // namespace gdtslam
