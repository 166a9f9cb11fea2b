// Compares the poses of `gdtslam localize` with known ones.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/io/json_file.hpp"
#include "engine/runs/evaluation/pose_table.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "evaluate.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostWrongShown = 20;

PoseLimits pose_limits(const EvaluateOptions& options) {
  PoseLimits limits;
  if (options.tolerance_s >= 0.0) limits.tolerance_s = options.tolerance_s;
  if (options.within.empty()) return limits;
  const auto [length_m, angle_rad] = length_and_angle("--within", options.within, "10cm/1deg");
  if (length_m <= 0.0 || angle_rad <= 0.0) {
    throw UsageError("--within: '" + options.within + "' is out of range: neither of them may be 0");
  }
  limits.within_m = length_m;
  limits.within_rad = angle_rad;
  return limits;
}

// Stamps of the scans that the map was made from.
std::vector<double> merged_stamps(const EvaluateOptions& options) {
  const std::string& folder = options.trajectory.empty() ? options.reference : options.trajectory;
  if (!RunReader::is_run(folder)) {
    throw UsageError("--leave-out needs the run of the map: give its folder as --trajectory or as --reference");
  }
  const RunReader run(folder);
  const std::vector<std::size_t>& merged = run.summary().keyframes;
  if (merged.empty()) {
    throw InputError({folder, 0},
                     "its report.json does not tell which scans went into the map (keyframe_scans): it is of an older "
                     "version; map the log again");
  }
  const Trajectory trajectory = run.trajectory();
  std::vector<double> stamps_s;
  stamps_s.reserve(merged.size());
  for (const std::size_t index : merged) stamps_s.push_back(trajectory[index].stamp_s);
  return stamps_s;
}

std::string share_row(const std::string& name, const Share& share) {
  return fmt::format("{:<16} {:>7} of {:>7}  {:>6.1f} %  ({:.1f} to {:.1f} %)\n", name, share.count, share.of,
                     100.0 * share.value(), 100.0 * share.low(), 100.0 * share.high());
}

std::string wrong_text(const PosesReport& report) {
  std::string text;
  for (std::size_t k = 0; k < report.wrong.size() && k < kMostWrongShown; ++k) {
    const WrongPose& wrong = report.wrong[k];
    text += fmt::format("  scan {}: {}", wrong.scan, wrong.state);
    text += wrong.error
                ? fmt::format(", {:.3f} m and {:.2f} deg off\n", wrong.error->position_m, wrong.error->angle_deg)
                : ", no pose\n";
  }
  if (report.wrong.size() > kMostWrongShown) {
    text += fmt::format("  and {} more; --json has all\n", report.wrong.size() - kMostWrongShown);
  }
  return text;
}

std::string poses_text(const PosesReport& report, const PoseLimits& limits, std::size_t left_out) {
  std::string text = fmt::format("within {:g} cm and {:g} deg of the reference, with the interval of 95 %:\n",
                                 100.0 * limits.within_m, deg_from_rad(limits.within_rad));
  text += share_row("all", report.within);
  for (const auto& [state, share] : report.states) text += share_row("  " + state, share);
  if (left_out > 0) text += plural(left_out, "scan") + " left out, near in time to one that went into the map\n";
  if (report.unmatched > 0) text += plural(report.unmatched, "scan") + " without a counterpart in the reference\n";
  if (!report.wrong.empty()) text += "not within them:\n" + wrong_text(report);
  text += "those within:\n" + errors_heading() + errors_row("position", report.distance_m, "m") +
          errors_row("heading", report.angle_deg, "deg");
  return report.stated ? text + stated_text(*report.stated, {}) : text;
}

Json share_json(const Share& share) {
  return {{"count", share.count},
          {"of", share.of},
          {"share", share.value()},
          {"low_95", share.low()},
          {"high_95", share.high()}};
}

Json poses_json(const EvaluateOptions& options, const PosesReport& report, const PoseLimits& limits,
                std::size_t left_out) {
  Json states = Json::object();
  for (const auto& [state, share] : report.states) states[state] = share_json(share);
  Json wrong = Json::array();
  for (const WrongPose& pose : report.wrong) {
    wrong.push_back({{"scan", pose.scan},
                     {"state", pose.state},
                     {"distance_m", pose.error ? Json(pose.error->position_m) : Json()},
                     {"angle_deg", pose.error ? Json(pose.error->angle_deg) : Json()}});
  }
  return {{"metric", "poses"},
          {"reference", options.reference},
          {"within_m", limits.within_m},
          {"within_deg", deg_from_rad(limits.within_rad)},
          {"within", share_json(report.within)},
          {"states", states},
          {"left_out", left_out},
          {"unmatched", report.unmatched},
          {"wrong", wrong},
          {"distance_m", errors_json(report.distance_m)},
          {"angle_deg", errors_json(report.angle_deg)},
          {"stated", report.stated ? stated_json(*report.stated, {}) : Json()}};
}

PosesReport compare_with_reference(const EvaluateOptions& options, const std::vector<FoundPose>& poses,
                                   const CloudFrame& frame, const PoseLimits& limits) {
  try {
    return compare_poses(poses, given_trajectory(options.reference), frame.T_truth_map, limits);
  } catch (const InputError& error) {
    if (error.has_position()) throw;
    throw InputError({options.reference, 0}, error.what());
  }
}

}  // namespace

int evaluate_poses(const EvaluateOptions& options) {
  const PoseLimits limits = pose_limits(options);
  std::vector<FoundPose> poses = read_pose_table(options.file);
  const std::size_t all = poses.size();
  if (options.leave_out_s >= 0.0) poses = without_near(std::move(poses), merged_stamps(options), options.leave_out_s);
  const CloudFrame frame = options.trajectory.empty() ? CloudFrame{} : align_cloud(options);
  const PosesReport report = compare_with_reference(options, poses, frame, limits);
  Json json = poses_json(options, report, limits, all - poses.size());
  json["alignment"] = frame_json(frame);
  print_result(options.json ? json_text(json)
                            : poses_text(report, limits, all - poses.size()) +
                                  frame_text(frame, "poses and reference", options.no_align));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace gdtslam
