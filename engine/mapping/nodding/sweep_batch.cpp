#include "sweep_batch.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "engine/mapping/map/scan_beams.hpp"

namespace gdtslam {
namespace {

template <class T>
std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span(values));
}

SweepPoints::Params params_for(const NoddingScanner& scanner, const AssemblyLimits& limits) {
  SweepPoints::Params params;
  params.table_bits = scanner.table.bits();
  params.lever_x_m = static_cast<float>(scanner.mount.lever_forward_m);
  params.lever_z_m = static_cast<float>(scanner.mount.lever_up_m);
  params.height_m = static_cast<float>(scanner.mount.height_m);
  params.form = limits.form;
  return params;
}

}  // namespace

void append_points(const SweepBatch& batch, const std::vector<SweptBeam>& swept, std::vector<CloudPoint>& points) {
  for (std::size_t i = 0; i < batch.beams.size(); ++i) {
    if (!(batch.beams[i].range_m > 0.0F)) continue;
    const std::uint32_t strip = batch.beams[i].strip;
    const StripOrigin& origin = batch.origins[strip];
    const std::size_t beam = origin.first_beam + (i - batch.strips[strip].first_beam);
    CloudPoint point;
    point.x_m = static_cast<float>(origin.anchor_x_m + static_cast<double>(swept[i][0]));
    point.y_m = static_cast<float>(origin.anchor_y_m + static_cast<double>(swept[i][1]));
    point.z_m = swept[i][2];
    point.elevation_rad = swept[i][3];
    point.stamp_s = origin.scan_stamp_s + origin.timing.of_beam_s(beam);
    point.scan = origin.scan;
    points.push_back(point);
  }
}

SweepDevice::SweepDevice(Backend& backend, const NoddingScanner& scanner, const AssemblyLimits& limits,
                         std::size_t most_beams)
    : backend_(backend),
      params_(params_for(scanner, limits)),
      elevations_(scanner.table.values_rad().begin(), scanner.table.values_rad().end()),
      beams_(backend.allocate(most_beams * sizeof(BeamRange))),
      points_(backend.allocate(most_beams * sizeof(SweptBeam))) {}

void SweepDevice::upload_tables(const std::shared_ptr<const BeamDirections>& directions) {
  const auto& rows = directions->rows();
  if (uploaded_ == directions && uploaded_rows_ == rows.size()) return;
  const auto elevations = bytes_of(elevations_);
  const auto directions_data = bytes_of(rows);
  const std::size_t bytes = elevations.size() + directions_data.size();
  if (tables_.bytes() < bytes) tables_ = backend_.allocate(std::bit_ceil(bytes));
  backend_.upload(tables_, elevations);
  backend_.upload(tables_, directions_data, elevations.size());
  uploaded_ = directions;
  uploaded_rows_ = rows.size();
}

PendingDownload SweepDevice::start(const SweepBatch& batch) {
  upload_tables(batch.directions);
  const auto strips = bytes_of(batch.strips);
  if (strips_.bytes() < strips.size()) strips_ = backend_.allocate(std::bit_ceil(strips.size()));
  backend_.upload(beams_, bytes_of(batch.beams));
  backend_.upload(strips_, strips);
  params_.beams = static_cast<std::uint32_t>(batch.beams.size());
  params_.strips = static_cast<std::uint32_t>(batch.strips.size());
  params_.directions = static_cast<std::uint32_t>(uploaded_rows_);
  run<SweepPoints>(backend_, params_, {params_.beams, 1, 1}, beams_, strips_, tables_, points_);
  PendingDownload download = backend_.start_download(points_, batch.beams.size() * sizeof(SweptBeam));
  backend_.flush();
  return download;
}

std::vector<SweptBeam> SweepDevice::finish(PendingDownload download) {
  std::vector<SweptBeam> swept(download.bytes / sizeof(SweptBeam));
  backend_.finish_download(std::move(download), std::as_writable_bytes(std::span(swept)));
  return swept;
}

std::optional<std::uint32_t> BeamDirections::row_of(const LaserScan& scan) {
  const std::size_t beams = scan.ranges_m.size();
  const auto is_same = [&](const Layout& layout) {
    return layout.first_bearing_rad == scan.first_bearing_rad && layout.bearing_step_rad == scan.bearing_step_rad &&
           layout.beams >= beams;
  };
  const auto found = std::find_if(layouts_.begin(), layouts_.end(), is_same);
  if (found != layouts_.end()) return found->row;
  if (!rows_.empty() && rows_.size() + beams > kMostRows) return std::nullopt;
  const auto row = static_cast<std::uint32_t>(rows_.size());
  layouts_.push_back({scan.first_bearing_rad, scan.bearing_step_rad, beams, row});
  for (std::size_t beam = 0; beam < beams; ++beam) {
    append(beam_bearing_rad(scan, beam));
  }
  return row;
}

void BeamDirections::clear() {
  layouts_.clear();
  rows_.clear();
}

// Rz(yaw) Rx(roll) (cos bearing, sin bearing, 0).
void BeamDirections::append(double bearing_rad) {
  const auto bearing = sin_cos(bearing_rad);
  const auto roll = sin_cos(mount_.sensor_roll_rad);
  const auto yaw = sin_cos(mount_.sensor_yaw_rad);
  const double left = bearing.sin * roll.cos;
  rows_.push_back({static_cast<float>(yaw.cos * bearing.cos - yaw.sin * left),
                   static_cast<float>(yaw.sin * bearing.cos + yaw.cos * left),
                   static_cast<float>(bearing.sin * roll.sin)});
}

}  // namespace gdtslam
