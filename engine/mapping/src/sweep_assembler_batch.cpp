#include "sweep_assembler_batch.hpp"

#include <bit>
#include <span>
#include <utility>

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
  for (std::size_t i = 0; i < batch.beams(); ++i) {
    if (!(batch.ranges_m[i] > 0.0F)) continue;
    const std::uint32_t strip = batch.strip_of_beam[i];
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
      ranges_(backend.allocate(most_beams * sizeof(float))),
      strip_of_beam_(backend.allocate(most_beams * sizeof(std::uint32_t))),
      points_(backend.allocate(most_beams * sizeof(SweptBeam))) {
  const std::vector<double>& table = scanner.table.values_rad();
  const std::vector<float> elevations(table.begin(), table.end());
  elevations_ = backend.allocate(elevations.size() * sizeof(float));
  backend.upload(elevations_, bytes_of(elevations));
}

void SweepDevice::upload_directions(const std::shared_ptr<const BeamDirections>& directions) {
  const auto& rows = directions->rows();
  if (uploaded_ == directions && uploaded_rows_ == rows.size()) return;
  const auto data = bytes_of(rows);
  if (directions_.bytes() < data.size()) directions_ = backend_.allocate(std::bit_ceil(data.size()));
  backend_.upload(directions_, data);
  uploaded_ = directions;
  uploaded_rows_ = rows.size();
}

PendingDownload SweepDevice::start(const SweepBatch& batch) {
  upload_directions(batch.directions);
  const auto strips = bytes_of(batch.strips);
  if (strips_.bytes() < strips.size()) strips_ = backend_.allocate(std::bit_ceil(strips.size()));
  backend_.upload(ranges_, bytes_of(batch.ranges_m));
  backend_.upload(strip_of_beam_, bytes_of(batch.strip_of_beam));
  backend_.upload(strips_, strips);
  params_.beams = static_cast<std::uint32_t>(batch.beams());
  params_.strips = static_cast<std::uint32_t>(batch.strips.size());
  params_.directions = static_cast<std::uint32_t>(uploaded_rows_);
  run<SweepPoints>(backend_, params_, {params_.beams, 1, 1}, ranges_, strip_of_beam_, strips_, directions_, elevations_,
                   points_);
  PendingDownload download = backend_.start_download(points_, batch.beams() * sizeof(SweptBeam));
  backend_.flush();
  return download;
}

std::vector<SweptBeam> SweepDevice::finish(PendingDownload download) {
  std::vector<SweptBeam> swept(download.bytes / sizeof(SweptBeam));
  backend_.finish_download(std::move(download), std::as_writable_bytes(std::span(swept)));
  return swept;
}

}  // namespace gdtslam
