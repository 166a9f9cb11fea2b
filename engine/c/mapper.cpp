// One scan in, one pose out.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "convert.hpp"
#include "engine/runs/motion/scan_speed.hpp"
#include "gdtslam/compute/backend.hpp"
#include "gdtslam/mapping/mapper.hpp"
#include "guard.hpp"
#include "options.hpp"

struct gdtslam_mapper {
  gdtslam_mapper(const gdtslam::MapperConfig& config, bool with_loops, const gdtslam::c::ThreadChoice& threads);

  std::unique_ptr<gdtslam::Backend> backend;
  std::unique_ptr<gdtslam::Mapper> mapper;
  gdtslam::LoopClosing* loops = nullptr;  ///< the mapper's, if it closes loops
  gdtslam::MapSpeed speed;
  bool is_closed = false;
  std::vector<gdtslam_stamped_pose> trajectory;
};

namespace {

using namespace gdtslam;
using namespace gdtslam::c;

gdtslam_match match_to_c(const MatchResult& result, const Pose2& correction) {
  return {.size = 0,
          .stamp_s = result.stamp_s,
          .T_map_base = to_c(result.T_map_base),
          .T_map_predicted = to_c(result.T_map_predicted),
          .correction = to_c(correction),
          .mean_distance_m = result.mean_cost_m,
          .overlap = result.overlap,
          .contradiction = result.contradiction,
          .points = result.points,
          .doubt = static_cast<int32_t>(result.doubt),
          .is_accepted = result.accepted ? 1 : 0,
          .is_keyframe = result.merged ? 1 : 0};
}

void require_open(const gdtslam_mapper& mapper, const char* what) {
  if (mapper.is_closed) throw UsageError(std::string(what) + ": the mapper is closed");
}

// The motion during the scan is completed from the map if the scan does not state it, as for a whole log.
MatchResult process(gdtslam_mapper& mapper, ScanRecord record) {
  mapper.speed.complete(record);
  const MatchResult result = mapper.mapper->process(record.scan, record.T_odom_base);
  mapper.speed.take(record, result.T_map_base);
  mapper.trajectory.push_back(to_c(StampedPose{result.stamp_s, result.T_map_base}));
  return result;
}

void close_loops(gdtslam_mapper& mapper, gdtslam_progress progress, void* user_data) {
  bool ended = false;
  const auto tell = [&](std::string_view step, double share) {
    if (progress != nullptr && progress(user_data, std::string(step).c_str(), 0, share) != 0) ended = true;
  };
  const ClosedPath path = mapper.loops->close(tell, [&ended] { return ended; });
  mapper.loops->finish_field();
  if (!path.is_closed) throw Error(ExitCode::kInterrupted, "interrupted; the path stays as it was driven");
  // A scan whose processing failed late may be only in the path.
  const std::size_t scans = std::min(path.T_map_base.size(), mapper.trajectory.size());
  for (std::size_t k = 0; k < scans; ++k) {
    mapper.trajectory[k] = to_c(StampedPose{mapper.trajectory[k].stamp_s, path.T_map_base[k]});
  }
}

std::unique_ptr<gdtslam_grid> copy_field(gdtslam_mapper& mapper) {
  if (mapper.loops == nullptr) return make_grid(rows_of(mapper.mapper->field()));
  if (mapper.is_closed) return make_grid(rows_of(mapper.loops->field()));
  const FrozenMap frozen = mapper.loops->request_map().get();
  return make_grid(rows_of(*frozen.field));
}

}  // namespace

gdtslam_mapper::gdtslam_mapper(const MapperConfig& config, bool with_loops, const ThreadChoice& threads)
    : backend(make_cpu_backend({.threads = threads.count, .isa = {}})) {
  MapperOptions options;
  options.cpu.threads = threads.count;
  options.loops_beside = threads.loops_beside;
  options.with_loops = with_loops;
  mapper = std::make_unique<Mapper>(config, *backend, options);
  loops = mapper->loops();
}

gdtslam_status gdtslam_mapper_new(const gdtslam_mapper_request* request, gdtslam_mapper** mapper,
                                  gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(mapper, "gdtslam_mapper_new: mapper");
    gdtslam_mapper_request given{};
    if (request != nullptr) given = read_struct(request, sizeof(given.size), "gdtslam_mapper_new: request");
    if ((given.flags & ~static_cast<uint32_t>(GDTSLAM_NO_LOOPS)) != 0) {
      throw UsageError("gdtslam_mapper_new: a flag that means nothing here");
    }
    *mapper = std::make_unique<gdtslam_mapper>(read_settings(given.options).mapper,
                                               (given.flags & GDTSLAM_NO_LOOPS) == 0, choose_threads(given.threads))
                  .release();
  });
}

void gdtslam_mapper_free(gdtslam_mapper* mapper) { delete mapper; }

gdtslam_status gdtslam_mapper_process(gdtslam_mapper* mapper, const gdtslam_scan* scan, gdtslam_match* match,
                                      gdtslam_error* error) {
  return guarded(error, [&] {
    require(mapper, "gdtslam_mapper_process: mapper");
    require_open(*mapper, "gdtslam_mapper_process");
    gdtslam_match unread{};
    unread.size = sizeof(unread);
    if (match == nullptr) match = &unread;
    write_struct(gdtslam_match{}, match, "gdtslam_mapper_process: match");  // before the scan counts
    const MatchResult result = process(*mapper, to_scan_record(scan, "gdtslam_mapper_process: scan"));
    write_struct(match_to_c(result, mapper->loops ? mapper->loops->correction() : Pose2()), match,
                 "gdtslam_mapper_process: match");
  });
}

gdtslam_status gdtslam_mapper_close(gdtslam_mapper* mapper, gdtslam_progress progress, void* user_data,
                                    gdtslam_error* error) {
  return guarded(error, [&] {
    require(mapper, "gdtslam_mapper_close: mapper");
    require_open(*mapper, "gdtslam_mapper_close");
    if (mapper->trajectory.empty()) throw InputError("gdtslam_mapper_close: no scan was mapped");
    mapper->is_closed = true;
    if (mapper->loops) close_loops(*mapper, progress, user_data);
  });
}

gdtslam_status gdtslam_mapper_trajectory(gdtslam_mapper* mapper, const gdtslam_stamped_pose** poses, size_t* count,
                                         gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(poses, "gdtslam_mapper_trajectory: poses");
    require(count, "gdtslam_mapper_trajectory: count");
    require(mapper, "gdtslam_mapper_trajectory: mapper");
    *poses = mapper->trajectory.data();
    *count = mapper->trajectory.size();
  });
}

gdtslam_status gdtslam_mapper_field(gdtslam_mapper* mapper, gdtslam_grid** field, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(field, "gdtslam_mapper_field: field");
    require(mapper, "gdtslam_mapper_field: mapper");
    *field = copy_field(*mapper).release();
  });
}
