#include "edit_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/mapping/map/scan_beams.hpp"
#include "engine/mapping/surface/wall_direction.hpp"
#include "engine/runs/edits/source_run.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "engine/runs/tiles/map_tiles.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr double kFarthestFromOrigin_m =
    10'000.0;  // from the origin: farther away, cells in single precision lose their fractions

std::vector<EditStep> recorded_steps(const std::string& file, const SourceRun& run) {
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

// The direction of the walls in the frame after the previous steps.
WallDirection find_walls(const SourceRun& run, const Pose2& T_edited_run) {
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
    const WallDirection walls = find_walls(run, so_far.T_edited_run);
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

// An edit must not move the map so far from the origin that it loses precision. A run that is already that far may
// stay, be turned, or come nearer.
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
  if (!request.again.empty()) steps = recorded_steps(request.again, run);
  const EditPlan earlier = run.earlier ? combine_steps(run.earlier->steps) : EditPlan{};
  if (!request.points.empty()) {
    GeoreferenceEdit edit{request.points, {}};
    edit.fit = fit_georeference(request.points);
    steps.emplace_back(std::move(edit));
  }
  if (std::optional<FrameEdit> frame = frame_edit(request, run, combine_steps(steps, earlier)))
    steps.emplace_back(*frame);
  for (const MapRegion& region : request.erased) steps.emplace_back(EraseEdit{region});
  if (request.crop) steps.emplace_back(CropEdit{request.crop->low_m, request.crop->high_m});
  if (request.with_world_file) steps.emplace_back(WorldFileEdit{});
  if (steps.empty() && !request.with_tiles) {
    throw UsageError(
        "nothing is to be done: name a step, as --rotate-to-walls, --origin, --crop, --erase, --georeference or "
        "--tiles");
  }
  check_distance(run, combine_steps(steps, earlier));
  return steps;
}

using Json = nlohmann::ordered_json;

void tell_step(const EditRequest& request, std::string_view step, double share) {
  if (request.progress) request.progress(step, share);
  if (request.stop && request.stop()) throw Error(ExitCode::kInterrupted, "interrupted; nothing was written");
}

MapRequest make_map_request(const EditRequest& request, const SourceRun& run) {
  MapRequest job;
  job.logs = run.reader.summary().logs;
  job.settings = run.settings;
  job.with_map = run.reader.summary().map.has_value();
  job.with_pictures = request.with_pictures;
  job.with_loops = run.kept.in_single_precision;
  job.finishing = [&request](std::string_view what) { tell_step(request, what, 1.0); };
  return job;
}

// True if map.pgm has all cells of the run; for a run in tiles it is a coarser overview.
bool has_all_cells(const SourceRun& run) {
  constexpr double kSameSize_m = 1.0e-9;
  const RunSummary& summary = run.reader.summary();
  return summary.tiles == 0 &&
         std::fabs(summary.map->resolution_m - run.settings.mapper.map.resolution_m) < kSameSize_m;
}

// True if beams of the scan may reach a kept region, by its bounds.
bool may_reach(const std::vector<MapRegion>& kept, const ScanConfig& valid, const LaserScan& scan, const Pose2& T) {
  double reach_m = range_limit_m(scan, valid.max_range_m) + scan.T_base_laser.translation().norm();
  if (is_skewed(scan)) {
    const double last_after_s =
        scan.first_beam_after_s + static_cast<double>(scan.ranges_m.size()) * scan.beam_period_s;
    reach_m += scan.speed->head<2>().norm() * std::fmax(std::fabs(scan.first_beam_after_s), std::fabs(last_after_s));
  }
  return std::all_of(kept.begin(), kept.end(), [&](const MapRegion& region) {
    const RegionBounds bounds = region_bounds(region);
    return T.x_m + reach_m >= bounds.low_m.x() && T.x_m - reach_m <= bounds.high_m.x() &&
           T.y_m + reach_m >= bounds.low_m.y() && T.y_m - reach_m <= bounds.high_m.y();
  });
}

// Casts the scans of the run again. Scans outside a crop are cast too, because their beams may end in it. For a run in
// tiles, too large for one piece, only scans that may reach the crop are cast.
OccupancyMap cast_map(const EditRequest& request, const SourceRun& run, EditOutcome& outcome) {
  const EditPlan& plan = outcome.plan;
  const ScanConfig& valid = run.settings.mapper.scan;
  OccupancyBuilder builder(run.settings.occupancy, occupancy_limits(run.settings.mapper));
  std::size_t count = 0;
  outcome.is_of_keyframes = !for_each_cast_scan(run, [&](LaserScan& scan, const Pose2& T, double share) {
    if (++count % 64 == 0) tell_step(request, "the occupancy map", share);
    if (run.reader.summary().tiles > 0 && !may_reach(plan.kept, valid, scan, T)) return;
    take_out_readings({.erased = plan.erased}, valid, T, scan);
    builder.add(scan, T);
    ++outcome.scans;
  });
  if (outcome.scans == 0 && !plan.kept.empty()) {
    throw InputError("--crop leaves nothing of the map: no scan reaches it");
  }
  return builder.build();
}

// The run's own cells if the edit only crops; else cells from its scans, with the changes between the drives of a site
// by its keyframes, whose erased readings are already removed.
OccupancyMap edited_map(const EditRequest& request, const SourceRun& run, EditOutcome& outcome) {
  const EditPlan& plan = outcome.plan;
  if (!plan.has_other_frame && plan.erased.empty() && has_all_cells(run)) {
    return cropped(run.reader.map(), plan.kept);
  }
  OccupancyMap map = cast_map(request, run, outcome);
  if (!run.outcome.drives.empty()) {
    tell_step(request, "what changed between the drives", 0.0);
    const DrivenKeyframes driven{run.kept.keyframes, run.outcome.trajectory, run.outcome.drives};
    mark_changes(changes_after_all(driven, run.settings.mapper), map);
  }
  return cropped(std::move(map), plan.kept);
}

// Warnings about the run's logs are kept; warnings about pictures are replaced by those of this edit.
void tell_of_pictures(const std::vector<LogReader::Warning>& warnings, Json& report) {
  Json told = Json::object();
  const Json before = report.value("warnings", Json::object());
  for (const auto& [kind, count] : before.items()) {
    if (!is_picture_warning(kind)) told[kind] = count;
  }
  for (const LogReader::Warning& warning : warnings) told[warning.kind] = warning.count;
  report["warnings"] = std::move(told);
}

// The run's report, with the values that the edit changed.
std::string edited_report(const EditRequest& request, const SourceRun& run, const EditPlan& plan,
                          const WrittenField& field, const WrittenHashes& hashes, const RunFolder& folder) {
  Json report = run.report;
  report["version"] = GDTSLAM_VERSION;
  report["map_sha256"] = field.sha256;
  report["trajectory_sha256"] = hashes.trajectory;
  report["keyframes_sha256"] = hashes.keyframes;
  report["gdt"] = geometry_json(field.geometry);
  report.erase("tiles");  // the result is in one piece
  report["files"] = files_json(folder);
  tell_of_pictures(run.outcome.warnings, report);
  if (report.contains("map")) report["map"] = geometry_json(run.outcome.occupancy.geometry);
  const Pose2& T = plan.T_edited_run;
  Json edited{{"run", request.run}, {"T_edited_run", {T.x_m, T.y_m, T.theta_rad}}};
  if (const auto& world = plan.T_world_edited) edited["T_world_edited"] = {world->x_m, world->y_m, world->theta_rad};
  report["edited"] = std::move(edited);
  return json_text(report);
}

void write_sessions(const SourceRun& run, RunFolder& folder) {
  auto begin = run.outcome.trajectory.begin();
  for (std::size_t k = 0; k < run.sessions.size(); ++k) {
    const auto end = begin + static_cast<std::ptrdiff_t>(run.sessions[k]);
    write_tum(folder.staged(session_file_name(k)), {begin, end});
    begin = end;
  }
}

void write_map_for_gis(const EditPlan& plan, const OccupancyMap& map, RunFolder& folder) {
  write_map_picture(folder.staged(kMapPicture), map);
  write_file_atomically(folder.staged(kWorldFile),
                        world_file_text(map.geometry, plan.T_world_edited.value_or(Pose2{})));
}

std::string recorded_edits(const EditRequest& request, const SourceRun& run, const EditOutcome& outcome) {
  RecordedEdits edits{.run = request.run, .begins_at_s = run.outcome.trajectory.front().stamp_s, .steps = {}};
  if (run.earlier) edits.steps = run.earlier->steps;
  edits.steps.insert(edits.steps.end(), outcome.steps.begin(), outcome.steps.end());
  return edits_text(edits, outcome.readings);
}

void take_out_of_keyframes(const EndRules& rules, SourceRun& run, EditOutcome& outcome) {
  for (RunKeyframe& keyframe : run.kept.keyframes) {
    outcome.readings += take_out_readings(rules, run.settings.mapper.scan, keyframe.T_map_base, keyframe.laser);
  }
}

void keep_keyframe_scans(SourceRun& run) {
  ScanPoints points(run.settings.mapper.scan);
  bool is_left = false;
  for (const RunKeyframe& keyframe : run.kept.keyframes) {
    is_left = is_left || !points.of(keyframe.laser).empty();
    run.outcome.keyframe_scans.push_back(keyframe.laser);
  }
  if (!is_left) throw InputError("--crop and --erase leave nothing that was seen: no map can be made of it");
}

// Writes the tiles of all keyframes, with the changes between the drives of a site as in its map.
void write_edited_tiles(const EditRequest& request, const SourceRun& run, const std::string& keyframes_sha256,
                        RunFolder& folder, EditOutcome& outcome) {
  const MapperConfig& config = run.settings.mapper;
  const TileParts parts = run.reader.summary().map ? TileParts::kBoth : TileParts::kDistances;
  const DrivenKeyframes driven{run.kept.keyframes, run.outcome.trajectory, run.outcome.drives};
  const TileMaker maker(run.kept, config, run.settings.occupancy, changes_after_all(driven, config), parts);
  const MadeTiles made =
      write_tiles(folder.staged_folder(kTileFolder), maker, keyframes_sha256, config.map.resolution_m,
                  [&request](double share) { tell_step(request, "the tiles", share); });
  outcome.tiles = made.index.tiles.size();
}

void write_edited(const EditRequest& request, SourceRun& run, RunFolder& folder, EditOutcome& outcome) {
  RunTimes times;
  const MapRequest job = make_map_request(request, run);
  take_out_of_keyframes({.erased = outcome.plan.erased}, run, outcome);
  if (job.with_map) run.outcome.occupancy = edited_map(request, run, outcome);
  take_out_of_keyframes({.kept = outcome.plan.kept}, run, outcome);
  keep_keyframe_scans(run);
  tell_step(request, "the distance field", 0.0);
  const std::unique_ptr<SeparateMap> map = map_of_keyframes(run.kept, run.settings.mapper);
  const WrittenField field = write_run_field(folder, job, map->field(), times);
  write_sessions(run, folder);
  if (outcome.plan.with_world_file) write_map_for_gis(outcome.plan, run.outcome.occupancy, folder);
  const WrittenHashes hashes = write_run_files(folder, job, times, run.outcome, &run.graph);
  if (request.with_tiles) write_edited_tiles(request, run, hashes.keyframes, folder, outcome);
  outcome.edits = recorded_edits(request, run, outcome);
  write_file_atomically(folder.staged(kEditsFile), outcome.edits);
  const std::string report = edited_report(request, run, outcome.plan, field, hashes, folder);
  write_file_atomically(folder.staged(kReportFile), report);
  tell_step(request, "report.json", 1.0);
  folder.commit();
  outcome.warnings = run.outcome.warnings;
}

}  // namespace

EditOutcome edit_run(const EditRequest& request) {
  check_request(request);
  RunFolder folder(request.folder, request.replace_foreign_files);
  tell_step(request, "reading the run", 0.0);
  SourceRun run = read_source_run(request.run);
  EditOutcome outcome;
  outcome.steps = resolved_steps(request, run);
  outcome.plan = combine_steps(outcome.steps, run.earlier ? combine_steps(run.earlier->steps) : EditPlan{});
  if (outcome.plan.with_world_file && !run.reader.summary().map) {
    throw InputError({request.run, 0}, "has no occupancy map, as it was mapped with --no-map: --world-file needs one");
  }
  if (outcome.plan.has_other_frame) move_to_frame(outcome.plan.T_edited_run, run);
  write_edited(request, run, folder, outcome);
  return outcome;
}

}  // namespace gdtslam
