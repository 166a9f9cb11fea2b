#include "merge_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <tuple>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/mapping/map/keyframe_map.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "engine/runs/keyframes/run_keyframes.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "engine/runs/sites/site_outcome.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

void require_runs_elsewhere(const MergeRequest& request) {
  for (const std::string& run : request.runs) {
    if (place_of_file(run) != place_of_file(request.folder) && !lies_in(request.folder, run)) continue;
    throw UsageError(
        fmt::format("--output: '{}' has a run to be joined, {}, which would be replaced; give another folder",
                    request.folder, run));
  }
}

void check(const MergeRequest& request) {
  if (request.stop && request.stop()) throw Error(ExitCode::kInterrupted, "interrupted; no site was written");
}

void tell(const MergeRequest& request, std::string_view what, double share) {
  if (request.progress) request.progress(what, share);
  check(request);
}

// Reads the runs sorted by time, so that the order of the arguments does not matter.
std::vector<RunSession> read_runs(const MergeRequest& request) {
  std::vector<RunSession> runs;
  runs.reserve(request.runs.size());
  for (const std::string& folder : request.runs) {
    tell(request, "reading runs", static_cast<double>(runs.size()) / static_cast<double>(request.runs.size()));
    runs.push_back(read_run_session(folder));
  }
  const auto key = [](const RunSession& run) {
    return std::make_tuple(run.trajectory.front().stamp_s, std::cref(run.keyframes_sha256));
  };
  std::sort(runs.begin(), runs.end(), [&](const RunSession& a, const RunSession& b) { return key(a) < key(b); });
  for (std::size_t i = 1; i < runs.size(); ++i) {
    if (runs[i].keyframes_sha256 != runs[i - 1].keyframes_sha256) continue;
    throw InputError({runs[i].folder, 0}, "is the same run as " + runs[i - 1].folder + ": name it once");
  }
  return runs;
}

std::vector<SharedRuns> find_shared(const std::vector<RunSession>& runs) {
  std::vector<const RunKeyframes*> kept;
  kept.reserve(runs.size());
  for (const RunSession& run : runs) kept.push_back(&run.kept);
  std::vector<SharedRuns> shared;
  for (const SharedScans& pair : shared_scans(kept)) {
    shared.push_back({runs[pair.first].folder, runs[pair.second].folder, pair.keyframes});
  }
  return shared;
}

// Merges all keyframes run by run, paper equations (1) and (9) to (11).
std::unique_ptr<SeparateMap> merge_map(const std::vector<const RunSession*>& runs, const MergedSite& site) {
  auto map = std::make_unique<SeparateMap>(runs.front()->settings.mapper);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    for (std::size_t i = 0; i < runs[k]->session.scans.size(); ++i) {
      map->merge(to_points(runs[k]->session.scans[i]), site.poses[k][i]);
    }
  }
  return map;
}

OccupancyMap cast_occupancy(const std::vector<const RunSession*>& runs, const MergedSite& site) {
  OccupancyBuilder builder(runs.front()->settings.occupancy, occupancy_limits(runs.front()->settings.mapper));
  for (std::size_t k = 0; k < runs.size(); ++k) {
    for (std::size_t i = 0; i < site.poses[k].size(); ++i) {
      builder.add(runs[k]->kept.keyframes[i].laser, site.poses[k][i]);
    }
  }
  return builder.build();
}

MapRequest make_map_request(const MergeRequest& request, const std::vector<const RunSession*>& runs) {
  MapRequest job;
  for (const RunSession* run : runs) job.logs.push_back(run->folder);
  job.settings = runs.front()->settings;
  job.with_map = request.with_map;
  job.with_pictures = request.with_pictures;
  job.with_loops = true;
  if (request.progress) job.finishing = [&request](std::string_view what) { request.progress(what, 1.0); };
  return job;
}

void draw_changes(const MergeRequest& request, const JoinedSite& joined, const MergedSite& site,
                  const std::vector<const RunSession*>& runs, RunFolder& folder, MapOutcome& outcome) {
  if (request.with_map && request.with_pictures && !joined.changes.last.empty()) {
    write_picture(folder, "changes", draw_changes_picture(joined.changes, outcome.occupancy, site, runs),
                  outcome.warnings);
  }
}

JoinedSite write_site(const MergeRequest& request, const MergedSite& site, const std::vector<RunSession*>& joined_runs,
                      const RunFolder& results, const std::string& name) {
  const std::vector<const RunSession*> runs(joined_runs.begin(), joined_runs.end());
  JoinedSite joined;
  joined.folder = results.file(name);
  RunTimes times;
  RunFolder folder(results.staged_path(name));
  std::vector<Trajectory> paths;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    paths.push_back(trajectory_in_site(*runs[k], site.poses[k]));
    write_tum(folder.staged(session_file_name(k)), paths.back());
    joined.runs.push_back({runs[k]->folder, runs[k]->name, name + "/" + session_file_name(k), paths.back().size()});
  }
  joined.changes = take_out_changes(site, joined_runs);
  MapOutcome outcome = site_outcome(site, runs, paths);
  const MapRequest job = make_map_request(request, runs);
  times.add("prepare");
  tell(request, "the map", 0.0);
  const std::unique_ptr<SeparateMap> map = merge_map(runs, site);
  outcome.match_distances_m = distances_from(map->field(), runs, site.poses);
  const WrittenField field = write_run_field(folder, job, map->field(), times);
  if (job.with_map) {
    outcome.occupancy = cast_occupancy(runs, site);
    mark_changes(joined.changes.last, outcome.occupancy);
  }
  draw_changes(request, joined, site, runs, folder, outcome);
  times.skip();
  check(request);
  const std::unique_ptr<Backend> cpu = make_cpu_backend({});
  write_run(folder, {job, nullptr, field, cpu->device()}, times, outcome);
  joined.keyframes = outcome.keyframes.size();
  joined.loops_between = site.loops_between;
  joined.loops_off = site.loops_off;
  joined.map_sha256 = field.sha256;
  return joined;
}

nlohmann::ordered_json search_json(const RunSearch& search) {
  const SessionOverlap& overlap = search.search.overlap;
  std::size_t agree = 0;
  for (const SessionEdge& edge : search.search.edges) agree += edge.held.size();
  return {{"run", search.query},
          {"searched_in", search.searched_in},
          {"is_joined", !search.search.edges.empty()},
          {"places", overlap.fixes.size()},
          {"possible", overlap.possible},
          {"unambiguous", overlap.alone},
          {"explained", overlap.explained},
          {"rival", overlap.rival},
          {"met", overlap.met},
          {"fitting", overlap.fitting},
          {"may_lie_elsewhere", search.search.may_lie_elsewhere},
          {"agree", agree}};
}

nlohmann::ordered_json edge_json(const SessionEdge& edge, const std::vector<RunSession>& runs) {
  nlohmann::ordered_json fixes = nlohmann::ordered_json::array();
  for (const SessionFix& fix : edge.held) {
    fixes.push_back({{"stamp_s", runs[edge.query].kept.keyframes.at(fix.keyframe).laser.stamp_s},
                     {"pose", {fix.T_map_keyframe.x_m, fix.T_map_keyframe.y_m, fix.T_map_keyframe.theta_rad}},
                     {"mean_distance_m", fix.mean_m},
                     {"elsewhere_at_least_m", fix.elsewhere_m},
                     {"overlap", fix.evidence.overlap},
                     {"contradiction", fix.evidence.contradiction}});
  }
  return {{"run", runs[edge.query].folder}, {"in", runs[edge.reference].folder}, {"fixes", std::move(fixes)}};
}

std::string report_text(const MergeOutcome& outcome, const std::vector<SessionEdge>& edges,
                        const std::vector<RunSession>& runs) {
  nlohmann::ordered_json report = nlohmann::ordered_json::object();
  report["format"] = kReportVersion;
  report["version"] = GDTSLAM_VERSION;
  report["sites"] = nlohmann::ordered_json::array();
  for (const JoinedSite& site : outcome.sites) {
    nlohmann::ordered_json joined = nlohmann::ordered_json::array();
    for (const JoinedRun& run : site.runs) {
      joined.push_back(
          {{"run", run.folder}, {"name", run.name}, {"trajectory", run.trajectory_file}, {"scans", run.scans}});
    }
    report["sites"].push_back({{"folder", std::filesystem::path(site.folder).filename().string()},
                               {"runs", std::move(joined)},
                               {"keyframes", site.keyframes},
                               {"loops_between", site.loops_between},
                               {"loops_switched_off", site.loops_off},
                               {"map_sha256", site.map_sha256},
                               {"changes", changes_json(site.changes)}});
  }
  report["searches"] = nlohmann::ordered_json::array();
  for (const RunSearch& search : outcome.searches) report["searches"].push_back(search_json(search));
  report["edges"] = nlohmann::ordered_json::array();
  for (const SessionEdge& edge : edges) report["edges"].push_back(edge_json(edge, runs));
  report["shared"] = nlohmann::ordered_json::array();
  for (const SharedRuns& pair : outcome.shared) {
    report["shared"].push_back({{"run", pair.run}, {"with", pair.with}, {"keyframes", pair.keyframes}});
  }
  return json_text(report);
}

}  // namespace

MergeOutcome merge_runs(const MergeRequest& request) {
  require_runs_elsewhere(request);
  RunFolder results(request.folder, request.replace_foreign_files);
  std::vector<RunSession> runs = read_runs(request);
  std::vector<Session> sessions;
  sessions.reserve(runs.size());
  for (const RunSession& run : runs) sessions.push_back(run.session);
  WorkerPool workers(threads_meant(request.threads));
  const MergedSessions merged = merge_sessions(
      sessions, request.options, workers, [&](std::string_view step, double share) { tell(request, step, share); });
  MergeOutcome outcome;
  outcome.shared = find_shared(runs);
  share_range_limits(runs);
  for (const SessionSearch& search : merged.searches) {
    RunSearch& told = outcome.searches.emplace_back(RunSearch{runs[search.query].folder, {}, search});
    for (const std::size_t k : search.searched_in) told.searched_in.push_back(runs[k].folder);
  }
  for (const MergedSite& site : merged.sites) {
    std::vector<RunSession*> of_site;
    of_site.reserve(site.sessions.size());
    for (const std::size_t k : site.sessions) of_site.push_back(&runs[k]);
    outcome.sites.push_back(write_site(request, site, of_site, results, std::to_string(outcome.sites.size() + 1)));
  }
  outcome.report = report_text(outcome, merged.edges, runs);
  check(request);
  write_file_atomically(results.staged(kMergeFile), outcome.report);
  results.commit();
  return outcome;
}

}  // namespace gdtslam
