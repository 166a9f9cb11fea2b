#include "run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "engine/core/quantile.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/logs/tum_row.hpp"
#include "engine/io/sha256.hpp"
#include "engine/mapping/map/store/field_store.hpp"
#include "engine/runs/folder/loop_files.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_review.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "engine/runs/tiles/map_tiles.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

double ratio(double a, double b) { return b > 0.0 ? a / b : 0.0; }

// CPU seconds. The mapper's are divided in proportion to its wall times; the rest is "other", so all add up.
Json stages_json(const MapOutcome& outcome, const std::vector<StageTime>& others) {
  const StageTimes& wall = outcome.statistics.stages;
  const double named_s = wall.predict_s + wall.match_s + wall.local_field_s + wall.merge_s;
  const double per_wall_s = ratio(outcome.mapper_cpu_s, std::max(outcome.mapper_s, named_s));
  std::vector<StageTime> stages{{"read", outcome.read_cpu_s},
                                {"predict", wall.predict_s * per_wall_s},
                                {"match", wall.match_s * per_wall_s},
                                {"local_field", wall.local_field_s * per_wall_s},
                                {"merge", wall.merge_s * per_wall_s},
                                {"mapper_other", std::max(outcome.mapper_cpu_s - named_s * per_wall_s, 0.0)}};
  if (outcome.closed) stages.push_back({"loops", outcome.loops_cpu_s});
  stages.push_back({"occupancy", outcome.occupancy_cpu_s});
  if (outcome.nodding) stages.push_back({"cloud", outcome.cloud_cpu_s});
  stages.insert(stages.end(), others.begin(), others.end());
  Json json = Json::object();
  double left_s = outcome.cpu_s;
  for (const StageTime& stage : stages) {
    json[stage.name] = stage.cpu_s;
    left_s -= stage.cpu_s;
  }
  json["other"] = std::max(left_s, 0.0);
  return json;
}

Json warnings_json(const std::vector<LogReader::Warning>& warnings) {
  Json counts = Json::object();
  for (const LogReader::Warning& warning : warnings) counts[warning.kind] = warning.count;
  return counts;
}

Json doubtful_json(const std::vector<DoubtfulScan>& doubtful) {
  Json list = Json::array();
  for (const DoubtfulScan& scan : doubtful) {
    list.push_back({{"index", scan.index},
                    {"stamp_s", scan.stamp_s},
                    {"reason", to_string(scan.reason)},
                    {"accepted", scan.accepted},
                    {"from_prediction_m", scan.from_prediction_m},
                    {"from_prediction_deg", deg_from_rad(scan.from_prediction_rad)}});
  }
  return list;
}

Json surface_json(const std::optional<PlanePatch>& surface) {
  if (!surface) return nullptr;
  return {{"height_m", surface->centre.z()}, {"rms_m", surface->rms_m}, {"sample_points", surface->points.size()}};
}

Json check_json(const SweepCheck& check) {
  return {{"pairs", check.pairs},
          {"not_held", check.not_held},
          {"apart", check.apart},
          {"mean_shift_m", check.mean_shift_m},
          {"max_shift_m", check.max_shift_m},
          {"mean_turn_deg", deg_from_rad(check.mean_turn_rad)},
          {"max_turn_deg", deg_from_rad(check.max_turn_rad)},
          {"drift_m", check.drift_m},
          {"drift_deg", deg_from_rad(check.drift_rad)},
          {"mean_rms_m", check.mean_rms_m},
          {"mean_moved_m", check.mean_moved_m},
          {"wall_s", check.wall_s}};
}

Json six_json(const Tangent3& six) {
  return {{"x_m", six[0]},
          {"y_m", six[1]},
          {"z_m", six[2]},
          {"about_x_deg", deg_from_rad(six[3])},
          {"about_y_deg", deg_from_rad(six[4])},
          {"about_z_deg", deg_from_rad(six[5])}};
}

Json space_json(const SpaceOutcome& space) {
  Json elevations = Json::array();
  for (const double knot_rad : space.elevation_knots_rad) elevations.push_back(deg_from_rad(knot_rad));
  return {{"surfels", space.surfels},
          {"pairs", space.pairs},
          {"rms_before_m", space.rms_before_m},
          {"rms_m", space.rms_m},
          {"rms_correction", six_json(space.rms_correction)},
          {"sigma",
           {{"z_m", space.sigma[2]},
            {"about_x_deg", deg_from_rad(space.sigma[3])},
            {"about_y_deg", deg_from_rad(space.sigma[4])}}},
          {"elevation_from_deg", deg_from_rad(space.lowest_rad)},
          {"elevation_to_deg", deg_from_rad(space.highest_rad)},
          {"elevation_correction_deg", std::move(elevations)},
          {"wall_s", space.wall_s}};
}

Json nodding_json(const NoddingJob& job, const NoddingOutcome& outcome) {
  const NoddingStatistics& statistics = outcome.statistics;
  const CloudSummary& cloud = outcome.cloud;
  Json json{{"linkage", job.linkage},
            {"told_by", job.kind == NodKind::kTilt ? "TILT" : "ENCODER"},
            {"sweeps", statistics.sweeps},
            {"fixes", statistics.fixes},
            {"between", statistics.between},
            {"smoothed", statistics.smoothed},
            {"by_odometry", statistics.by_odometry},
            {"before_first_fix", statistics.before_first_fix},
            {"dropped", statistics.dropped},
            {"without_nod", statistics.without_nod},
            {"smooth_s", statistics.smooth_s},
            {"assemble_s", statistics.assemble_s},
            {"sweep_check", check_json(outcome.check)}};
  if (outcome.space) json["space"] = space_json(*outcome.space);
  if (outcome.has_cloud) {
    json["cloud"] = {{"measured", cloud.measured},
                     {"after_thinning", cloud.thinned},
                     {"removed", cloud.removed},
                     {"written", cloud.written},
                     {"sha256", cloud.sha256},
                     {"floor", surface_json(cloud.surfaces.floor)},
                     {"ceiling", surface_json(cloud.surfaces.ceiling)}};
  }
  return json;
}

// Matches accepted without doubt, accepted with weak evidence, and refused: too few points, or the scan contradicts.
Json matches_json(const MapOutcome& outcome) {
  const auto weak = std::count_if(outcome.doubtful.begin(), outcome.doubtful.end(),
                                  [](const DoubtfulScan& scan) { return scan.accepted; });
  const auto doubtful = static_cast<std::ptrdiff_t>(outcome.doubtful.size());
  return {{"accepted", static_cast<std::ptrdiff_t>(scans_of(outcome)) - doubtful},
          {"weak", weak},
          {"refused", doubtful - weak}};
}

// How well scans fit the map at the time of their matches; adds nothing if none was matched.
void add_match_distances(Json& report, std::vector<double> distances_m) {
  if (distances_m.empty()) return;
  std::sort(distances_m.begin(), distances_m.end());
  report["match_median_m"] = quantile_of_sorted(distances_m, 0.5);
  report["match_p99_m"] = quantile_of_sorted(distances_m, 0.99);
}

// Writes covariances and graph of the path if its loops were closed.
void write_path_facts(RunFolder& folder, const MapOutcome& outcome, const GraphLines* graph) {
  if (!outcome.closed) return;
  write_file_atomically(folder.staged("covariance.csv"),
                        covariance_text(outcome.trajectory, outcome.closed->covariances));
  write_file_atomically(folder.staged("graph.g2o"),
                        graph != nullptr ? graph_lines_text(*graph) : graph_text(*outcome.closed));
}

std::string config_yaml(const MapRequest& request) {
  Settings settings = request.settings;
  return config_text(option_table(settings));
}

// The scans that the map was merged from.
RunKeyframes kept_keyframes(const std::string& config, const MapRequest& request, const MapOutcome& outcome) {
  RunKeyframes run{
      .config_sha256 = Sha256().update(config).hex(), .in_single_precision = request.with_loops, .keyframes = {}};
  run.keyframes.reserve(outcome.keyframes.size());
  for (std::size_t k = 0; k < outcome.keyframes.size(); ++k) {
    const std::size_t scan = outcome.keyframes[k];
    RunKeyframe keyframe{.scan = scan,
                         .T_map_base = outcome.trajectory[scan].T_map_base,
                         .covariance = {},
                         .laser = outcome.keyframe_scans[k]};
    if (outcome.closed && scan < outcome.closed->covariances.size()) {
      keyframe.covariance = outcome.closed->covariances[scan];
    }
    run.keyframes.push_back(std::move(keyframe));
  }
  return run;
}

// Writes the keyframes' scans unless the laser nods: then they are points, not ranges of one plane. Returns the hash.
std::string write_merged_scans(RunFolder& folder, const std::string& config, const MapRequest& request,
                               const MapOutcome& outcome) {
  if (outcome.keyframe_scans.size() != outcome.keyframes.size()) return {};
  return write_keyframes(folder.staged(kKeyframeFile), kept_keyframes(config, request, outcome));
}

Json work_json(const QueueWork& work) {
  return {{"dispatches", work.dispatch_sum()},
          {"submissions", work.submissions},
          {"waits", work.waits},
          {"wait_s", work.wait_s},
          {"bytes_up", work.upload_bytes},
          {"bytes_down", work.download_bytes}};
}

Json run_report(const RunFacts& facts, const MapOutcome& outcome, const WrittenHashes& hashes, Json files,
                const std::vector<StageTime>& others) {
  const MapperStatistics& statistics = outcome.statistics;
  const auto scans = static_cast<double>(scans_of(outcome));
  Json report = Json::object();
  report["format"] = kReportVersion;
  report["version"] = GDTSLAM_VERSION;
  report["device"] = device_json(facts.device);
  if (!outcome.device_loss.empty()) report["device_lost"] = outcome.device_loss;
  report["log"] = facts.request.logs;
  report["interrupted"] = outcome.interrupted;
  report["scans"] = scans_of(outcome);
  report["matched"] = statistics.matched;
  add_match_distances(report, outcome.match_distances_m);
  report["doubtful"] = statistics.doubtful;
  report["matches"] = matches_json(outcome);
  report["keyframes"] = statistics.keyframes;
  report["searches"] = statistics.searches;
  report["windows"] = statistics.attempts;
  report["restarts"] = statistics.restarts;
  report["odometry_leaps"] = statistics.odometry_leaps;
  report["without_odometry"] = statistics.without_odometry;
  report["evaluations"] = statistics.evaluations;
  report["dispatches"] = statistics.dispatches;
  report["submissions"] = statistics.submissions;
  if (statistics.device.submissions > 0) {
    report["device_work"] = {{"mapping", work_json(statistics.device - outcome.adjusting)},
                             {"adjusting", work_json(outcome.adjusting)}};
  }
  report["path_m"] = statistics.path_m;
  report["log_duration_s"] = outcome.log_duration_s;
  report["wall_s"] = outcome.wall_s;
  report["cpu_s"] = outcome.cpu_s;
  report["scans_per_s"] = ratio(scans, outcome.wall_s);
  report["scans_per_core_s"] = ratio(scans, outcome.mapper_cpu_s);  // mapper alone: no reading, no occupancy map
  report["realtime_factor"] = ratio(outcome.log_duration_s, outcome.wall_s);
  report["map_sha256"] = facts.field.sha256;
  report["trajectory_sha256"] = hashes.trajectory;
  if (!hashes.keyframes.empty()) report["keyframes_sha256"] = hashes.keyframes;
  report["gdt"] = geometry_json(facts.field.geometry);
  if (facts.field.tiles > 0) report["tiles"] = facts.field.tiles;
  if (facts.request.with_map) report["map"] = geometry_json(outcome.occupancy.geometry);
  report["cloud_points"] = outcome.nodding ? outcome.nodding->cloud.written : 0;
  if (facts.nodding != nullptr) report["nodding"] = nodding_json(*facts.nodding, *outcome.nodding);
  if (const std::optional<OdometryDelay>& delay = outcome.odometry_delay) {
    report["odometry_delay"] = {{"delay_s", delay->delay_s}, {"sigma_s", delay->sigma_s}};
  }
  if (outcome.closed) {
    report["loops"] = loops_json(*outcome.closed);
    report["wheels"] = wheels_json(outcome.closed->wheels);
    report["uncertain"] = uncertain_json(*outcome.closed, outcome.trajectory);
  }
  report["files"] = std::move(files);
  report["warnings"] = warnings_json(outcome.warnings);
  report["findings"] = findings_json(outcome.findings);
  report["stages"] = stages_json(outcome, others);
  report["doubtful_scans"] = doubtful_json(outcome.doubtful);
  report["keyframe_scans"] = outcome.keyframes;
  if (!outcome.drives.empty()) report["drives"] = outcome.drives;
  return report;
}

// A picture has cells for everything between its scans, so a few scans far away could make it larger than any disk.
void require_bounded(const GridGeometry& geometry, std::uint64_t max_cells) {
  const auto width = static_cast<std::uint64_t>(geometry.width);
  const auto height = static_cast<std::uint64_t>(geometry.height);
  if (width == 0 || height <= max_cells / width) return;
  throw InputError(fmt::format("the map is {} x {} cells{}; a few scans that lie far away may be why", width, height,
                               limit_of_option(max_cells)));
}

}  // namespace

WrittenField write_run_field(RunFolder& folder, const MapRequest& request, const GlobalField& field, RunTimes& times) {
  require_bounded(field.geometry(), static_cast<std::uint64_t>(request.settings.mapper.map.max_megacells) << 20U);
  if (request.finishing) request.finishing("gdt.png");
  folder.staged("gdt.png");
  write_distance_field(folder.staged("gdt.yaml"), rows_of(field));
  times.add("write_field");
  WrittenField written{.geometry = field.geometry(), .sha256 = sha256_of(rows_of(field))};
  times.add("hash");
  return written;
}

// Makes tiles from the keyframes as stored in their file, so that making them again gives the same tiles.
WrittenField write_run_tiles(RunFolder& folder, const MapRequest& request, RunTimes& times, MapOutcome& outcome) {
  const RunKeyframes kept = kept_keyframes(config_yaml(request), request, outcome);
  const std::string bytes = keyframe_bytes(kept);
  const RunKeyframes run = parse_keyframes(bytes, kKeyframeFile);
  const TileParts parts = request.with_map ? TileParts::kBoth : TileParts::kDistances;
  const TileMaker maker(run, request.settings.mapper, request.settings.occupancy, {}, parts);
  MadeTiles made = write_tiles(folder.staged_folder(kTileFolder), maker, Sha256().update(bytes).hex(),
                               request.settings.mapper.map.resolution_m, [&request](double share) {
                                 if (request.finishing)
                                   request.finishing(fmt::format("tiles, {:.0f} %", 100.0 * share));
                               });
  outcome.occupancy = std::move(made.overview);
  times.add("write_tiles");
  return {.geometry = tiles_geometry(made.index), .sha256 = sha256_of(made.index), .tiles = made.index.tiles.size()};
}

// In space, if it has such poses.
void write_trajectory(const std::string& path, const MapOutcome& outcome) {
  if (!outcome.nodding || !outcome.nodding->space) return write_tum(path, outcome.trajectory);
  const std::vector<Pose3>& poses = outcome.nodding->space->T_map_base;
  std::string rows;
  for (std::size_t k = 0; k < poses.size(); ++k) rows += tum_row(outcome.trajectory[k].stamp_s, poses[k]);
  write_file_atomically(path, rows);
}

WrittenHashes write_run_files(RunFolder& folder, const MapRequest& request, RunTimes& times, MapOutcome& outcome,
                              const GraphLines* graph) {
  const auto tell = [&request](const char* what) {
    if (request.finishing) request.finishing(what);
  };
  tell("trajectory.tum");
  write_trajectory(folder.staged("trajectory.tum"), outcome);
  write_path_facts(folder, outcome, graph);
  times.add("write_path");
  write_run_pictures(folder, request, outcome);
  times.add("write_pictures");
  const std::string config = config_yaml(request);
  write_file_atomically(folder.staged("config.yaml"), config);
  tell(kKeyframeFile);
  WrittenHashes hashes{sha256_of(outcome.trajectory), write_merged_scans(folder, config, request, outcome)};
  times.add("write_keyframes");
  if (!request.with_map) return hashes;
  tell("map.pgm");
  folder.staged("map.pgm");
  write_occupancy_map(folder.staged("map.yaml"), outcome.occupancy);
  times.add("write_map");
  return hashes;
}

std::string write_run(RunFolder& folder, RunFacts facts, RunTimes& times, MapOutcome& outcome) {
  const WrittenHashes hashes = write_run_files(folder, facts.request, times, outcome);
  Json files = files_json(folder);
  times.read_whole(outcome.wall_s, outcome.cpu_s);
  std::string report = json_text(run_report(facts, outcome, hashes, std::move(files), times.stages()));
  write_file_atomically(folder.staged(kReportFile), report);
  folder.commit();
  return report;
}

nlohmann::ordered_json geometry_json(const GridGeometry& geometry) {
  return {{"resolution_m", geometry.resolution_m},
          {"origin_m", {geometry.origin_x_m, geometry.origin_y_m}},
          {"width", geometry.width},
          {"height", geometry.height}};
}

}  // namespace gdtslam
