// Finds scans in a map, and follows a robot in it.
#include "engine/runs/localizer/run.hpp"

#include <cmath>
#include <memory>
#include <string>

#include "convert.hpp"
#include "engine/runs/localizer/tracking.hpp"
#include "gdtslam/compute/backend.hpp"
#include "guard.hpp"
#include "options.hpp"

/// The parts that a localizer and its trackers share.
struct gdtslam_localizer {
  struct Shared {
    Shared(const std::string& map, const gdtslam::MapperConfig& mapper_config, const gdtslam::LocalizeLimits& limits)
        : config(mapper_config),
          backend(gdtslam::make_cpu_backend({})),
          localizer(map, mapper_config, limits, *backend) {}
    gdtslam::MapperConfig config;
    std::unique_ptr<gdtslam::Backend> backend;
    gdtslam::Localizer localizer;
  };
  std::shared_ptr<const Shared> shared;
};

struct gdtslam_tracker {
  explicit gdtslam_tracker(std::shared_ptr<const gdtslam_localizer::Shared> map)
      : shared(std::move(map)),
        backend(gdtslam::make_cpu_backend({})),
        tracker(shared->localizer, shared->config, *backend) {}
  std::shared_ptr<const gdtslam_localizer::Shared> shared;
  std::unique_ptr<gdtslam::Backend> backend;  ///< belongs to one thread
  gdtslam::RobotTracker tracker;
};

namespace {

using namespace gdtslam;
using namespace gdtslam::c;

LocalizeLimits read_limits(const gdtslam_localizer_request& given) {
  for (const double value : {given.gap_m, given.max_seconds, given.good_fit_m}) {
    if (!(value >= 0.0) || !std::isfinite(value))
      throw UsageError("gdtslam_localizer_new: a limit is negative or not finite");
  }
  LocalizeLimits limits;
  if (given.gap_m > 0.0) limits.gap_m = given.gap_m;
  if (given.max_seconds > 0.0) limits.max_seconds = given.max_seconds;
  if (given.good_fit_m > 0.0) limits.good_fit_m = given.good_fit_m;
  limits.with_runner_up = (given.flags & GDTSLAM_NO_RUNNER_UP) == 0;
  return limits;
}

gdtslam_location location_to_c(const LocalizedScan& found) {
  gdtslam_location location{};
  location.verdict = static_cast<int32_t>(found.verdict);
  location.points = found.points;
  if (found.best) {
    location.T_map_base = to_c(found.best->T_map_base);
    location.mean_distance_m = found.best->mean_cost_m;
    location.proven_gap_m = found.best->gap_m;
  }
  if (found.runner_up && found.runner_up->stop != CertifiedStop::kNothingAllowed) {
    location.has_runner_up = 1;
    location.runner_up = to_c(found.runner_up->T_map_base);
    location.runner_up_mean_distance_m = found.runner_up->mean_cost_m;
  }
  return location;
}

gdtslam_tracked tracked_to_c(const TrackedPose& pose) {
  const PoseCovariance& p = pose.covariance;
  return {.size = 0,
          .whereabouts = static_cast<int32_t>(pose.whereabouts),
          .is_ambiguous = pose.is_ambiguous ? 1 : 0,
          .T_map_base = to_c(pose.T_map_base),
          .explained = pose.explained,
          .mean_distance_m = pose.mean_distance_m,
          .covariance = {p.xx, p.xy, p.xt, p.yy, p.yt, p.tt}};
}

}  // namespace

gdtslam_status gdtslam_localizer_new(const gdtslam_localizer_request* request, gdtslam_localizer** localizer,
                                     gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(localizer, "gdtslam_localizer_new: localizer");
    const gdtslam_localizer_request given =
        read_struct(request, GDTSLAM_SIZE_WITH(gdtslam_localizer_request, map), "gdtslam_localizer_new: request");
    require(given.map, "gdtslam_localizer_new: map");
    if ((given.flags & ~static_cast<uint32_t>(GDTSLAM_NO_RUNNER_UP)) != 0 || given.reserved != 0) {
      throw UsageError("gdtslam_localizer_new: a flag that means nothing here");
    }
    auto made = std::make_unique<gdtslam_localizer>();
    made->shared = std::make_shared<const gdtslam_localizer::Shared>(given.map, read_settings(given.options).mapper,
                                                                     read_limits(given));
    *localizer = made.release();
  });
}

void gdtslam_localizer_free(gdtslam_localizer* localizer) { delete localizer; }

gdtslam_status gdtslam_localizer_find(const gdtslam_localizer* localizer, const gdtslam_scan* scan,
                                      gdtslam_location* location, gdtslam_error* error) {
  return guarded(error, [&] {
    require(localizer, "gdtslam_localizer_find: localizer");
    const ScanRecord record = to_scan_record(scan, "gdtslam_localizer_find: scan");
    write_struct(gdtslam_location{}, location, "gdtslam_localizer_find: location");  // before the work
    write_struct(location_to_c(localizer->shared->localizer.localize(record.scan, 0)), location,
                 "gdtslam_localizer_find: location");
  });
}

gdtslam_status gdtslam_tracker_new(const gdtslam_localizer* localizer, gdtslam_tracker** tracker,
                                   gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(tracker, "gdtslam_tracker_new: tracker");
    require(localizer, "gdtslam_tracker_new: localizer");
    *tracker = std::make_unique<gdtslam_tracker>(localizer->shared).release();
  });
}

void gdtslam_tracker_free(gdtslam_tracker* tracker) { delete tracker; }

gdtslam_status gdtslam_tracker_follow(gdtslam_tracker* tracker, const gdtslam_scan* scan, gdtslam_tracked* tracked,
                                      gdtslam_error* error) {
  return guarded(error, [&] {
    require(tracker, "gdtslam_tracker_follow: tracker");
    const ScanRecord record = to_scan_record(scan, "gdtslam_tracker_follow: scan");
    write_struct(gdtslam_tracked{}, tracked, "gdtslam_tracker_follow: tracked");  // before the scan counts
    write_struct(tracked_to_c(tracker->tracker.follow(record.scan, record.T_odom_base)), tracked,
                 "gdtslam_tracker_follow: tracked");
  });
}
