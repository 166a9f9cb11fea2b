#include "space_path.hpp"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "engine/mapping/strokes/stroke_adjustment.hpp"
#include "stopwatch.hpp"

namespace gdtslam {

SpacePath::SpacePath(const NoddingMount& mount, std::string scratch_folder)
    : mount_(mount), points_(std::move(scratch_folder)) {}

void SpacePath::take(const NoddingPose& pose, const NoddingScan& scan) {
  if (path_.poses.empty()) {
    path_.first_scan = pose.scan;
    const Point2 axis = scan.record.scan.T_base_laser * Point2(-mount_.lever_forward_m, 0.0);
    path_.axis_base_m = {axis.x(), axis.y(), mount_.height_m - mount_.lever_up_m};
  }
  path_.poses.push_back({pose.stamp_s, pose.T_map_base});
}

void SpacePath::add(std::span<const CloudPoint> points) {
  for (const CloudPoint& point : points) {
    lowest_rad_ = std::min(lowest_rad_, static_cast<double>(point.elevation_rad));
    highest_rad_ = std::max(highest_rad_, static_cast<double>(point.elevation_rad));
  }
  surfels_.add(points);
  points_.put({std::as_bytes(points)});
}

SpaceOutcome SpacePath::solve(unsigned threads, const std::function<void(double)>& progress) {
  SpaceOutcome outcome;
  Stopwatch watch;
  if (!(lowest_rad_ <= highest_rad_)) lowest_rad_ = highest_rad_ = 0.0;  // no point
  const std::vector<Surfel> surfels = surfels_.finish();
  path_.strokes = surfels_.strokes();
  correction_.emplace(std::move(path_), lowest_rad_, highest_rad_);
  WorkerPool workers(threads);
  const StrokeAdjustment found = adjust_strokes(surfels, {}, workers, *correction_, progress);
  outcome.surfels = found.surfels;
  outcome.pairs = found.pairs;
  outcome.rms_before_m = found.rms_before_m;
  outcome.rms_m = found.rms_m;
  outcome.rms_correction = found.rms_correction;
  outcome.sigma = found.sigma;
  outcome.T_map_base = correction_->poses();
  outcome.elevation_knots_rad = correction_->elevation_knots_rad;
  outcome.lowest_rad = lowest_rad_;
  outcome.highest_rad = highest_rad_;
  watch.add_to(outcome.wall_s);
  return outcome;
}

void SpacePath::give(const std::function<void(std::span<const CloudPoint>)>& sink) const {
  ByteShelf::Reader reader(points_);
  std::vector<CloudPoint> points;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const std::span<const std::byte> bytes = reader.next();
    points.resize(bytes.size() / sizeof(CloudPoint));
    std::memcpy(points.data(), bytes.data(), points.size() * sizeof(CloudPoint));
    correction_->correct(points);
    sink(points);
  }
}

}  // namespace gdtslam
