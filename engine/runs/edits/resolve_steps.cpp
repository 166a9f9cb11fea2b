#include "resolve_steps.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>

#include "engine/mapping/surface/wall_direction.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr double kFarthestFromOrigin_m =
    10'000.0;  // from the origin: beyond that, cells in single precision lose their fractions

std::vector<EditStep> steps_of(const std::string& file, const SourceRun& run) {
  if (run.earlier) {
    throw InputError(
        {run.reader.folder(), 0},
        "was edited already: --again takes the run before its edits, as 'gdtslam map' or 'merge' wrote it");
  }
  const RecordedEdits recorded = read_edits(file);
  const double begins_at_s = run.outcome.trajectory.front().stamp_s;
  if (recorded.begins_at_s != begins_at_s) {
    throw InputError({file, 0},
                     fmt::format("is of a run that begins at {:.3f} s, and {} begins at {:.3f} s: another frame, in "
                                 "which these steps would be elsewhere",
                                 recorded.begins_at_s, run.reader.folder(), begins_at_s));
  }
  return recorded.steps;
}

// Of the walls, in the frame after the steps so far.
WallDirection walls_of(const SourceRun& run, const Pose2& T_edited_run) {
  WallDirectionFinder finder;
  ScanPoints points(run.settings.mapper.scan);
  for (const RunKeyframe& keyframe : run.kept.keyframes) {
    finder.add(points.of(keyframe.laser), T_edited_run * keyframe.T_map_base);
  }
  if (const std::optional<WallDirection> found = finder.direction()) return *found;
  throw InputError(
      {run.reader.folder(), 0},
      "has no direction in which most of its walls run; --origin X,Y,THETA turns the map by a stated angle");
}

std::optional<FrameEdit> frame_edit(const EditRequest& request, const SourceRun& run, const EditPlan& so_far) {
  if (!request.along_walls && !request.north_up && !request.origin) return std::nullopt;
  FrameEdit edit;
  if (request.origin) edit.T_before_after = request.origin->pose;
  if (request.along_walls) {
    const WallDirection walls = walls_of(run, so_far.T_edited_run);
    edit.by = FrameEdit::By::kWalls;
    edit.T_before_after.theta_rad = walls.angle_rad;
    edit.walls_share = walls.share;
  } else if (request.north_up) {
    if (!so_far.T_world_edited) {
      throw UsageError("--north-up: nothing says where north is: give --georeference points with it");
    }
    edit.by = FrameEdit::By::kNorth;
    edit.T_before_after.theta_rad = wrap_angle(-so_far.T_world_edited->theta_rad);
  }
  return edit;
}

// An edit must not put the map so far from the origin that it loses its precision. A run that goes that far itself may
// stay where it is, be turned, and come nearer.
void check_distance(const SourceRun& run, const EditPlan& plan) {
  constexpr double kRounding_m = 1.0e-3;
  double before_m = 0.0;
  double after_m = 0.0;
  double along_axis_m = 0.0;
  for (const StampedPose& pose : run.outcome.trajectory) {
    const Point2 at_m = plan.T_edited_run * pose.T_map_base.translation();
    before_m = std::fmax(before_m, pose.T_map_base.translation().norm());
    after_m = std::fmax(after_m, at_m.norm());
    along_axis_m = std::fmax(along_axis_m, at_m.cwiseAbs().maxCoeff());
  }
  if (along_axis_m <= kFarthestFromOrigin_m || after_m <= before_m + kRounding_m) return;
  throw UsageError(
      fmt::format("--origin: puts the map {:.0f} m from its origin, and {:.0f} m is the most; coordinates "
                  "of a country go into --georeference and --world-file",
                  along_axis_m, kFarthestFromOrigin_m));
}

}  // namespace

void check_request(const EditRequest& request) {
  std::error_code ignored;
  if (std::filesystem::equivalent(request.run, request.folder, ignored)) {
    throw UsageError("--output: is the run itself, which is left alone: give another folder");
  }
  if (request.along_walls && request.north_up) {
    throw UsageError("--rotate-to-walls and --north-up each turn the map: give one of them");
  }
  if (request.origin && request.origin->has_angle && (request.along_walls || request.north_up)) {
    throw UsageError(fmt::format("--origin: its THETA turns the map, and so does {}: leave one of them out",
                                 request.along_walls ? "--rotate-to-walls" : "--north-up"));
  }
}

std::vector<EditStep> resolved_steps(const EditRequest& request, const SourceRun& run) {
  std::vector<EditStep> steps;
  if (!request.again.empty()) steps = steps_of(request.again, run);
  const EditPlan earlier = run.earlier ? plan_of(run.earlier->steps) : EditPlan{};
  if (!request.points.empty()) {
    GeoreferenceEdit edit{request.points, {}};
    edit.fit = fit_georeference(request.points);
    steps.emplace_back(std::move(edit));
  }
  if (std::optional<FrameEdit> frame = frame_edit(request, run, plan_of(steps, earlier))) steps.emplace_back(*frame);
  for (const MapRegion& region : request.erased) steps.emplace_back(EraseEdit{region});
  if (request.crop) steps.emplace_back(CropEdit{request.crop->low_m, request.crop->high_m});
  if (request.with_world_file) steps.emplace_back(WorldFileEdit{});
  if (steps.empty() && !request.with_tiles) {
    throw UsageError(
        "nothing is to be done: name a step, as --rotate-to-walls, --origin, --crop, --erase, --georeference or "
        "--tiles");
  }
  check_distance(run, plan_of(steps, earlier));
  return steps;
}

}  // namespace gdtslam
