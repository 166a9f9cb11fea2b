// Figures 13 to 15: what a standing scanner sees of its surroundings, and two office floors in 3D from a drive.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "asset_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "render_source.hpp"
#include "render_studio.hpp"
#include "reproduce_draw.hpp"
#include "reproduce_drives.hpp"
#include "run_reader.hpp"
#include "scene_errors.hpp"

namespace gdtslam::reproduce {
namespace {

std::size_t index_of(const GridGeometry& grid, CellIndex cell) {
  return static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(cell.x);
}

// Distances of the cloud's points to the scene's true surfaces.
SceneErrors surface_errors(const Drive& drive, const Workplace& place, bool is_aligned, double from, double span) {
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

void add_standing(Part& part, const Workplace& place, const std::string& name, const std::string& what,
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
  part.rows.push_back({fmt::format("points, {} ahead", what), "", with_commas(errors.distances.count()), Verdict::kOpen,
                       "every beam that returned, in 40 s"});
  part.rows.push_back(surface_row(fmt::format("distance to surfaces, {} ahead", what), errors));
  for (const std::string& command : Drives::commands_of(name)) part.by_hand.push_back(command);
  part.by_hand.push_back(fmt::format("gdtslam render {} --view iso --camera={}", name, camera));
}

// Of the occupied cells of the 2D map, those that scans raised by more than 2 degrees have a point near, in the plane.
double contour_share(const std::string& run) {
  constexpr float kRaised_rad = 0.035F;
  constexpr double kNear_m = 0.05;
  const RunReader reader(run);
  const OccupancyMap map = reader.map();
  const auto reach = static_cast<std::int32_t>(std::ceil(kNear_m / map.geometry.resolution_m));
  std::vector<bool> is_near(map.geometry.cell_count());
  for (const CloudPoint& point : read_whole_cloud(reader.cloud_file().value(), {})) {
    if (std::fabs(point.elevation_rad) < kRaised_rad) continue;
    const CellIndex middle = map.geometry.cell_of({static_cast<double>(point.x_m), static_cast<double>(point.y_m)});
    for (std::int32_t k = 0; k < (2 * reach + 1) * (2 * reach + 1); ++k) {
      const CellIndex cell = middle + CellOffset{k % (2 * reach + 1) - reach, k / (2 * reach + 1) - reach};
      if (map.geometry.contains(cell)) is_near[index_of(map.geometry, cell)] = true;
    }
  }
  std::size_t walls = 0;
  std::size_t seen = 0;
  for (std::size_t k = 0; k < map.cells.size(); ++k) {
    if (map.cells[k] != CellState::kOccupied) continue;
    ++walls;
    seen += is_near[k] ? 1U : 0U;
  }
  return walls > 0 ? static_cast<double>(seen) / static_cast<double>(walls) : 0.0;
}

void add_floor_views(Part& part, const Workplace& place, const Drive& drive, const std::string& floor) {
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

void add_floor_rows(Part& part, const Workplace& place, const Drive& drive) {
  const RunSummary summary = RunReader(drive.run).summary();
  const ReferenceReport path = errors_of(drive);
  part.rows.push_back(
      {"points in the map", "", with_commas(summary.cloud_points), Verdict::kOpen,
       fmt::format("thinned, from {} scans along {:.0f} m", with_commas(summary.scans), summary.path_m)});
  part.rows.push_back(surface_row("distance to surfaces", surface_errors(drive, place, true, 0.5, 0.5)));
  part.rows.push_back(
      {"error of the robot\u2019s path (ATE)", "",
       fmt::format("{} mean, {} at most", length_with_unit(path.ate_m.mean), length_with_unit(path.ate_m.max)),
       Verdict::kOpen, "best rigid alignment with the true path"});
  const double share = contour_share(drive.run);
  constexpr double kAlmost = 0.9;
  part.rows.push_back({"walls of the 2D map that the 3D map has", "contours almost the same",
                       fmt::format("{:.1f} %", 100.0 * share), share >= kAlmost ? Verdict::kWithin : Verdict::kOutside,
                       "occupied cells with points of raised scans within 5 cm; within: 90 % and more"});
}

Part make_floor(const Workplace& place, const std::string& scene, const std::string& title) {
  const Drive drive = place.drives.drive(scene);
  Part part;
  part.source = fmt::format(
      "The scene {}, seed 1, a floor like that of the figure, drawn by us; the laser nods on the linkage "
      "paper-b "
      "while the robot drives.",
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

}  // namespace

Part make_standing(const Workplace& place) {
  Part part;
  part.source =
      "The scanner stands at two places of the scene office-3f, seed 1, which has an open elevator and "
      "plants.";
  add_standing(part, place, "at-elevator", "an open elevator",
               "the open elevator is the recess in the wall on the left", "-4.2,-2.2,3.6,3.2,0.9,0.7,46", 0.0);
  add_standing(part, place, "at-plant", "a plant", "the plant stands before the wall ahead",
               "-3.6,-0.2,2.6,3,-0.4,0.8,46", 0.5);
  part.notes.push_back(
      "As in the paper, one place is not enough: walls hide most of the floor. Figures 14 and 15 are the remedy.");
  return part;
}

Part make_floor_3f(const Workplace& place) { return make_floor(place, "office-3f", "3F"); }
Part make_floor_7f(const Workplace& place) { return make_floor(place, "office-7f", "7F"); }

}  // namespace gdtslam::reproduce
