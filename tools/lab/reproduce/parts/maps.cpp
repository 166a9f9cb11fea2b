// Figures 4 and 7: the field of one scan, and a loop mapped with it; in 2D.
#include <fmt/format.h>

#include <optional>
#include <string>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/io/log.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/pictures/studio.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/lab/reproduce/drives.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {
namespace {

struct MapView {
  std::string view;
  std::string size = "1190x820";
  std::string title;
  bool has_path = true;
};
void add_map_view(Part& part, const PartContext& place, const std::string& run, const MapView& map, Picture picture) {
  RenderOptions look;
  look.title = map.title;
  look.no_path = !map.has_path;
  add_view(part, place, {.inputs = {run}, .view = map.view, .size = map.size, .options = look}, std::move(picture));
}

/// First and last pose that the wheels alone give.
struct WheelPath {
  std::optional<Pose2> first;
  Pose2 last;
};
WheelPath wheel_path_of(const std::string& log, double until_s) {
  WheelPath path;
  const auto reader = open_log(log, {});
  while (const auto record = reader->next()) {
    const auto* const scan = std::get_if<ScanRecord>(&*record);
    if (scan == nullptr || !scan->T_odom_base) continue;
    if (scan->scan.stamp_s > until_s) break;
    if (!path.first) path.first = scan->T_odom_base;
    path.last = *scan->T_odom_base;
  }
  return path;
}

/// The pose of the true path that is nearest to its begin after it was farthest away: the loop is closed there, though
/// the drive may go on.
std::size_t back_at_start(const Trajectory& truth) {
  const auto away_m = [&truth](std::size_t i) {
    return (truth[i].T_map_base.translation() - truth.front().T_map_base.translation()).norm();
  };
  std::size_t farthest = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) farthest = away_m(i) > away_m(farthest) ? i : farthest;
  std::size_t back = farthest;
  for (std::size_t i = farthest; i < truth.size(); ++i) back = away_m(i) < away_m(back) ? i : back;
  return back;
}

Trajectory until(Trajectory path, double stamp_s) {
  while (path.size() > 1 && path.back().stamp_s > stamp_s) path.pop_back();
  return path;
}

/// How far off the end is, seen from the begin.
struct EndError {
  double distance_m = 0.0;
  double angle_deg = 0.0;
};
EndError end_error(const Pose2& first, const Pose2& last, const Trajectory& truth) {
  const Pose2 T_first_last = between(first, last);
  const Pose2 truly = between(truth.front().T_map_base, truth.back().T_map_base);
  const Pose2 error = between(truly, T_first_last);
  return {Point2(error.x_m, error.y_m).norm(), deg_from_rad(std::abs(error.theta_rad))};
}

std::string as_text(const EndError& error) {
  return fmt::format("{}, {:.2f}\u00b0", length_with_unit(error.distance_m), error.angle_deg);
}

double path_length_m(const Trajectory& path) {
  double length_m = 0.0;
  for (std::size_t k = 1; k < path.size(); ++k) {
    const Pose2 step = between(path[k - 1].T_map_base, path[k].T_map_base);
    length_m += Point2(step.x_m, step.y_m).norm();
  }
  return length_m;
}

void add_loop_rows(Part& part, const Drive& drive, const Drive& closed) {
  constexpr double kClosedShare = 0.001;
  constexpr double kSameStamp_s = 1.0e-3;
  Trajectory truth = read_tum(drive.truth);
  truth.resize(back_at_start(truth) + 1);
  const double until_s = truth.back().stamp_s + kSameStamp_s;
  const auto end_of = [&](const Drive& run) {
    const Trajectory path = until(read_tum(run.run + "/trajectory.tum"), until_s);
    return end_error(path.front().T_map_base, path.back().T_map_base, truth);
  };
  const EndError end = end_of(drive);
  part.claim(fmt::format("back at the start after {:.0f} m of path", path_length_m(truth)), "start and end coincide",
             as_text(end), end.distance_m < kClosedShare * path_length_m(truth),
             "off the truth, seen from the start; rule: at most 0.1 % of the path. As in the paper no loop closure is "
             "done (--no-loops). The drive goes on from there");
  part.state("the same with loops closed, as is the default", "", as_text(end_of(closed)),
             "beyond the paper, whose system closes none");
  const WheelPath wheels = wheel_path_of(drive.log, until_s);
  part.state("the same by the wheels alone", "", as_text(end_error(*wheels.first, wheels.last, truth)),
             "what matching corrects");
  const auto all_poses = [](const Drive& run) {
    const ReferenceReport errors = errors_of(run);
    return fmt::format("{} mean, {} at most", length_with_unit(errors.ate_m.mean), length_with_unit(errors.ate_m.max));
  };
  part.state("error of all poses (ATE)", "", all_poses(drive),
             "best rigid alignment with the true path; the paper had no truth to compare with");
  part.state("the same with loops closed", "", all_poses(closed), "");
}

void add_real_log(Part& part, const PartContext& place, const RealLog& real, double from, double span) {
  const TemporaryFolder folder("gdtslam-reproduce");
  const std::string run = folder.path() + "/run";
  map_whole(real.log, run, place.device, [&](double share) { place.progress(from + span * share); });
  const RelationReport report = evaluate_relations(read_tum(run + "/trajectory.tum"), read_relations(real.relations));
  const std::string title = real.name + " (real)";
  add_map_view(part, place, run, {.view = "map", .title = title},
               {real.stem + "-map.png", fmt::format("Real log, {}: occupancy map and path.", real.name)});
  if (part.origin != Origin::kSimulatedAndReal) {  // one is enough to see
    add_map_view(part, place, run, {.view = "field", .title = title},
                 {real.stem + "-field.png", fmt::format("Real log, {}: distance transform as intensity.", real.name)});
  }
  part.state(
      real.name + " (real): error of verified relations", "",
      fmt::format("{} and {:.2f}\u00b0 mean", length_with_unit(report.all.translation_m.mean),
                  report.all.rotation_deg.mean),
      fmt::format(
          "{} relations of [Kuemmerle2009], with loops closed; those of loops alone {}. Not a log of the paper\u2019s",
          with_commas(report.all.translation_m.count), length_with_unit(report.loops.translation_m.mean)));
  part.by_hand.push_back(fmt::format("gdtslam map {0}.clf.gz -o {0} && gdtslam render {0} --view map", real.stem));
  part.by_hand.push_back(fmt::format("gdtslam evaluate {0}/trajectory.tum --relations {0}.relations.gz", real.stem));
  part.origin = Origin::kSimulatedAndReal;
}

void add_real_logs(Part& part, const PartContext& place) {
  const std::vector<RealLog> logs = real_logs(place.data);
  for (std::size_t k = 0; k < logs.size(); ++k) {
    const double span = 0.9 / static_cast<double>(logs.size());
    add_real_log(part, place, logs[k], 0.1 + span * static_cast<double>(k), span);
    part.source +=
        fmt::format("{}{}{}", k == 0 ? " Real: the logs " : ", ", logs[k].name, k + 1 == logs.size() ? "." : "");
  }
}

}  // namespace

Part make_local_scan(const PartContext& place) {
  const Drive drive = place.drives.drive("one-scan");
  Part part;
  part.source = "One scan of 961 beams over 240\u00b0 at a crossing of the scene office-loop, seed 1.";
  add_map_view(part, place, drive.run, {.view = "map", .size = "1190x680", .title = "One scan", .has_path = false},
               {"scan.png", "(a) What one scan tells: walls, free space, unknown."});
  add_map_view(part, place, drive.run,
               {.view = "field", .size = "1190x680", .title = "Its distance transform", .has_path = false},
               {"field.png", "(b) Its distance transform as intensity: bright near obstacles, as in the paper."});
  part.notes.push_back("A picture to be compared by eye: the paper gives no number for it.");
  part.by_hand = Drives::commands_of("one-scan");
  part.by_hand.push_back(
      "gdtslam render one-scan --view map --no-path && gdtslam render one-scan --view field --no-path");
  return part;
}

Part make_loop(const PartContext& place) {
  const Drive drive = place.drives.drive("office-loop-matched");
  Part part;
  part.source =
      "A drive through the scene office-loop, seed 1, an office floor with a loop of corridors like the paper\u2019s "
      "7F.";
  add_map_view(part, place, drive.run, {.view = "map", .title = "2D map and path"},
               {"map.png", "(a) Occupancy map with the robot\u2019s path in the colours of time."});
  add_map_view(part, place, drive.run, {.view = "field", .title = "GDT and path"},
               {"field.png", "(b) The global distance transform as intensity, with the path."});
  add_loop_rows(part, drive, place.drives.drive("office-loop"));
  part.by_hand = Drives::commands_of("office-loop-matched");
  part.by_hand.push_back(
      "gdtslam render office-loop-matched --view map && gdtslam render office-loop-matched --view field");
  part.by_hand.push_back(
      "gdtslam evaluate office-loop-matched/trajectory.tum --reference office-loop-matched.truth.tum");
  add_real_logs(part, place);
  return part;
}

}  // namespace gdtslam::reproduce
