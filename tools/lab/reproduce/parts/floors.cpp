// Figures 13 to 15: what a standing scanner sees of its surroundings, and two office floors in 3D from a drive.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/sim/ray_caster.hpp"
#include "tools/gdtslam/pictures/source.hpp"
#include "tools/gdtslam/pictures/studio.hpp"
#include "tools/gdtslam/scenes/scene_errors.hpp"
#include "tools/gdtslam/scenes/scene_file.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/lab/reproduce/drives.hpp"
#include "tools/lab/reproduce/paper.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {
namespace {

// Distances of the cloud's points to the scene's true surfaces.
SceneErrors surface_errors(const Drive& drive, const PartContext& place, bool is_aligned, double from, double span) {
  SceneErrorsJob job{
      .cloud = drive.run + "/cloud.ply", .scene = drive.scene, .scene_folders = asset_folders("scenes"), .frame = {}};
  job.frame.trajectory = errors_of(drive, is_aligned);
  job.frame.T_truth_map = job.frame.trajectory->T_reference_estimate;
  job.progress = [&](std::uint64_t, double share) { place.progress(from + span * share); };
  job.stop = place.stop;
  SceneErrors errors = scene_errors(job);
  if (errors.interrupted) throw Error(ExitCode::kInterrupted, "interrupted");
  return errors;
}

Row surface_row(const std::string& what, const SceneErrors& errors) {
  return {what, "",
          fmt::format("{} mean, {} for 95 %", length_with_unit(errors.distances.mean_m()),
                      length_with_unit(errors.distances.quantile_m(0.95))),
          Verdict::kOpen, "of all points to the scene\u2019s true surfaces; the paper shows pictures only"};
}

void add_standing(Part& part, const PartContext& place, const std::string& name, const std::string& what,
                  const std::string& where, const std::string& camera, double from) {
  const Drive drive = place.drives.drive(name);
  RenderOptions look;
  look.title = "From one place: " + what;
  look.camera = camera;
  add_view(
      part, place, {.inputs = {drive.run}, .view = "iso", .size = "1600x860", .options = look},
      {name + ".png",
       fmt::format("The scanner stands in the corridor; {}. Without the ceiling; what hides behind walls stays empty.",
                   where)});
  const SceneErrors errors = surface_errors(drive, place, false, from + 0.3, 0.2);
  part.state(fmt::format("points, {} ahead", what), "", with_commas(errors.distances.count()),
             "every beam that returned, in 40 s");
  part.rows.push_back(surface_row(fmt::format("distance to surfaces, {} ahead", what), errors));
  for (const std::string& command : Drives::commands_of(name)) part.by_hand.push_back(command);
  part.by_hand.push_back(fmt::format("gdtslam render {} --view iso --camera={}", name, camera));
}

// What level beams meet from where the robot truly was, half a metre apart, in the map's frame.
std::vector<Point2> true_contour(const Drive& drive, const Pose2& T_truth_map) {
  constexpr double kStep_m = 0.5;
  constexpr int kBeams = 720;
  const SceneFile scene = read_scene(drive.scene);
  const sim::RayCaster caster(triangulate(scene.scene));
  const Pose2 T_map_truth = inverse(T_truth_map);
  std::vector<Point2> contour;
  Point2 last = Point2::Constant(std::numeric_limits<double>::infinity());
  for (const StampedPose& stamped : read_tum(drive.truth)) {
    const Point2 eye = (stamped.T_map_base * scene.config.T_base_laser).translation();
    if ((eye - last).norm() < kStep_m) continue;
    last = eye;
    for (int k = 0; k < kBeams; ++k) {
      const SinCos<double> bearing = sin_cos(kTwoPi * k / kBeams);
      const Point2 direction(bearing.cos, bearing.sin);
      const sim::Ray ray{{eye.x(), eye.y(), scene.config.laser_height_m}, {direction.x(), direction.y(), 0.0}};
      const auto hit = caster.cast(ray, scene.config.laser.max_range_m);
      if (hit) contour.push_back(T_map_truth * Point2(eye + hit->range_m * direction));
    }
  }
  return contour;
}

void add_floor_views(Part& part, const PartContext& place, const Drive& drive, const std::string& floor) {
  RenderOptions look;
  look.title = floor + ": 2D map";
  add_view(part, place, {.inputs = {drive.run}, .view = "map", .size = "1190x640", .options = look},
           {"map.png", "(a) 2D map of the horizontal scans, with the path."});
  look.no_floor = true;
  look.title = floor + " from above";
  add_view(part, place, {.inputs = {drive.run}, .view = "top", .size = "1190x640", .options = look},
           {"top.png", "From above, floor and ceiling taken away."});
  look.title = floor + " in 3D";
  add_view(
      part, place, {.inputs = {drive.run}, .view = "iso", .size = "1800x1000", .options = look},
      {"iso.png", "(b) The 3D map, floor and ceiling taken away as planes that were found in it; colours by height."});
}

void add_floor_rows(Part& part, const PartContext& place, const Drive& drive) {
  const RunSummary summary = RunReader(drive.run).summary();
  const ReferenceReport path = errors_of(drive);
  part.state("points in the map", "", with_commas(summary.cloud_points),
             fmt::format("thinned, from {} scans along {:.0f} m", with_commas(summary.scans), summary.path_m));
  part.rows.push_back(surface_row("distance to surfaces", surface_errors(drive, place, true, 0.5, 0.5)));
  part.state("error of the robot\u2019s path (ATE)", "",
             fmt::format("{} mean, {} at most", length_with_unit(path.ate_m.mean), length_with_unit(path.ate_m.max)),
             "best rigid alignment with the true path");
  const RunReader run(drive.run);
  const ContourShares shares = contour_shares(run.map(), read_whole_cloud(run.cloud_file().value(), {}),
                                              true_contour(drive, path.T_reference_estimate));
  const auto add_share = [&part](const std::string& quantity, double share, const std::string& what) {
    constexpr double kAlmost = 0.9;
    part.claim(quantity, "contours almost the same", fmt::format("{:.1f} %", 100.0 * share), share >= kAlmost,
               what + "; rule: 90 % and more");
  };
  add_share("walls of the 2D map that the 3D map has", shares.of_map,
            "occupied cells with points of raised scans within 5 cm");
  add_share("walls of the 3D map that the 2D map has", shares.of_cloud,
            "cells over which points of raised scans span 1 m of height, with an occupied one within 5 cm");
  add_share("true walls in sight that the 3D map has", shares.of_truth,
            "what level beams from the true path meet, with points of raised scans within 5 cm");
}

Part make_floor(const PartContext& place, const std::string& scene, const std::string& title) {
  const Drive drive = place.drives.drive(scene);
  Part part;
  part.source = fmt::format(
      "The scene {}, seed 1, a floor like that of the figure, drawn by us; the laser nods on the linkage paper-b while "
      "the robot drives.",
      scene);
  add_floor_views(part, place, drive, title);
  place.progress(0.5);
  add_floor_rows(part, place, drive);
  part.by_hand = Drives::commands_of(scene);
  part.by_hand.push_back(
      fmt::format("gdtslam render {0} --view iso --no-floor && gdtslam render {0} --view top --no-floor", scene));
  part.by_hand.push_back(fmt::format(
      "gdtslam evaluate {0}/cloud.ply --scene {0} --trajectory {0}/trajectory.tum --reference {0}.truth.tum", scene));
  return part;
}

using Cell = std::pair<std::int32_t, std::int32_t>;  // y before x, as the rows of a map lie

// Of the cells, those with one of the others within the reach; the others are sorted.
double share_near(const std::vector<Cell>& cells, const std::vector<Cell>& others, std::int32_t reach) {
  std::size_t near = 0;
  for (const auto& [y, x] : cells) {
    bool is_near = false;
    for (std::int32_t v = y - reach; v <= y + reach && !is_near; ++v) {
      const auto first = std::lower_bound(others.begin(), others.end(), Cell{v, x - reach});
      is_near = first != others.end() && *first <= Cell{v, x + reach};
    }
    near += is_near ? 1U : 0U;
  }
  return cells.empty() ? 0.0 : static_cast<double>(near) / static_cast<double>(cells.size());
}

/// The points of scans raised by more than 2 degrees: those of level scans are the 2D map over again.
std::vector<std::pair<Cell, float>> raised_points(const GridGeometry& grid, std::span<const CloudPoint> cloud) {
  constexpr float kRaised_rad = 0.035F;
  std::vector<std::pair<Cell, float>> raised;
  for (const CloudPoint& point : cloud) {
    if (std::fabs(point.elevation_rad) < kRaised_rad) continue;
    const CellIndex cell = grid.cell_of({static_cast<double>(point.x_m), static_cast<double>(point.y_m)});
    raised.push_back({{cell.y, cell.x}, point.z_m});
  }
  std::sort(raised.begin(), raised.end());  // by cell, then by height
  return raised;
}

}  // namespace

Part make_standing(const PartContext& place) {
  Part part;
  part.source =
      "The scanner stands at two places of the scene office-3f, seed 1, which has an open elevator and plants.";
  add_standing(part, place, "at-elevator", "an open elevator",
               "the open elevator is the recess in the wall on the left", "-4.2,-2.2,3.6,3.2,0.9,0.7,46", 0.0);
  add_standing(part, place, "at-plant", "a plant", "the plant stands before the wall ahead",
               "-3.6,-0.2,2.6,3,-0.4,0.8,46", 0.5);
  part.notes.push_back(
      "As in the paper, one place is not enough: walls hide most of the floor. Figures 14 and 15 are the remedy.");
  return part;
}

Part make_floor_3f(const PartContext& place) { return make_floor(place, "office-3f", "3F"); }
Part make_floor_7f(const PartContext& place) { return make_floor(place, "office-7f", "7F"); }

ContourShares contour_shares(const OccupancyMap& map, std::span<const CloudPoint> cloud,
                             std::span<const Point2> truth) {
  constexpr double kNear_m = 0.05;
  constexpr float kWall_m = 1.0F;  // lintels and furniture span less
  std::vector<Cell> seen;
  std::vector<Cell> walls;
  const std::vector<std::pair<Cell, float>> raised = raised_points(map.geometry, cloud);
  for (auto first = raised.begin(); first != raised.end();) {
    const auto end =
        std::find_if(first, raised.end(), [first](const auto& other) { return other.first != first->first; });
    seen.push_back(first->first);
    if (std::prev(end)->second - first->second >= kWall_m) walls.push_back(first->first);
    first = end;
  }
  std::vector<Cell> occupied;
  for (std::size_t k = 0; k < map.cells.size(); ++k) {
    const auto width = static_cast<std::size_t>(map.geometry.width);
    if (map.cells[k] != CellState::kOccupied) continue;
    occupied.emplace_back(static_cast<std::int32_t>(k / width), static_cast<std::int32_t>(k % width));
  }
  const auto reach = static_cast<std::int32_t>(std::ceil(kNear_m / map.geometry.resolution_m));
  std::vector<Cell> surfaces;
  for (const Point2& point : truth) {
    const CellIndex cell = map.geometry.cell_of(point);
    surfaces.emplace_back(cell.y, cell.x);
  }
  std::sort(surfaces.begin(), surfaces.end());
  surfaces.erase(std::unique(surfaces.begin(), surfaces.end()), surfaces.end());
  return {share_near(occupied, seen, reach), share_near(walls, occupied, reach), share_near(surfaces, seen, reach)};
}

}  // namespace gdtslam::reproduce
