#include "part.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/pictures/studio.hpp"

namespace gdtslam::reproduce {
namespace {

std::vector<PartInfo> parts_in_2d() {
  return {
      {.id = "fig3",
       .label = "Figure 3",
       .title = "A small distance transform",
       .paper = "a grid of ten by ten cells, before and after the distance transform, with the numbers in the cells.",
       .weight_s = 0.1,
       .make = make_cells},
      {.id = "fig4",
       .label = "Figure 4",
       .title = "The distance transform of one scan",
       .paper = "the points of one scan, and its distance transform as a grey picture that is bright near obstacles.",
       .weight_s = 0.2,
       .drives = {"one-scan"},
       .make = make_local_scan},
      {.id = "fig7",
       .label = "Figure 7",
       .title = "A floor mapped in 2D, with a loop",
       .paper = "the map of an office floor with the robot\u2019s path, which ends where it began, and the global "
                "distance transform behind it.",
       .weight_s = 0.3,
       .drives = {"office-loop-matched", "office-loop"},
       .data_weight_s = 6.5,
       .make = make_loop},
      {.id = "fig8",
       .also = "table1",
       .label = "Figure 8, table 1",
       .title = "Four optimizers against the best solution",
       .paper =
           "how far the poses of PSO, SCE, SIMPSA and simplex are from the global solution, scan by scan and in sum.",
       .weight_s = 36.0,
       .drives = {"office-loop"},
       .data_weight_s = 62.0,
       .make = make_optimizer_errors},
      {.id = "fig9",
       .also = "table2",
       .label = "Figure 9, table 2",
       .title = "Four optimizers against the true position",
       .paper =
           "how far the robot\u2019s position is from the ground truth with each optimizer, and the time that each "
           "takes.",
       .weight_s = 75.0,
       .drives = {"office-loop", "office-loop-2", "office-loop-3"},
       .data_weight_s = 24.0,
       .make = make_optimizer_positions},
  };
}

std::vector<PartInfo> parts_in_3d() {
  return {
      {.id = "fig11",
       .label = "Figure 11",
       .title = "The crank-rocker linkage",
       .paper = "the four-bar linkage that nods the laser: one bar turns all the way round, another swings to and fro.",
       .weight_s = 0.3,
       .make = make_linkages},
      {.id = "fig12",
       .label = "Figure 12",
       .title = "Three boxes, measured",
       .paper =
           "three boxes on the floor, their 3D map from one place, and their widths read off its projection to the "
           "floor.",
       .weight_s = 4.0,
       .drives = {"three-boxes"},
       .make = make_boxes},
      {.id = "fig13",
       .label = "Figure 13",
       .title = "Surroundings from one place",
       .paper = "3D maps from two places of a floor, an elevator and a plant among what is seen, and photographs "
                "beside them.",
       .weight_s = 4.0,
       .drives = {"at-elevator", "at-plant"},
       .make = make_standing},
      {.id = "fig14",
       .label = "Figure 14",
       .title = "An office floor in 3D: 3F",
       .paper = "the 2D map of the third floor and its 3D map from a moving robot, without floor and ceiling.",
       .weight_s = 4.0,
       .drives = {"office-3f"},
       .make = make_floor_3f},
      {.id = "fig15",
       .label = "Figure 15",
       .title = "An office floor in 3D: 7F",
       .paper = "the same of the seventh floor.",
       .weight_s = 4.5,
       .drives = {"office-7f"},
       .make = make_floor_7f},
      {.id = "figA",
       .label = "Figure A",
       .title = "The linkage calibrated before a wall",
       .paper = "ranges to a wall over the encoder, measured and as the linkage has them, before and after its lengths "
                "are fitted.",
       .weight_s = 0.2,
       .drives = {"wall"},
       .make = make_calibration},
  };
}

}  // namespace

const std::vector<PartInfo>& part_list() {
  static const std::vector<PartInfo> parts = [] {
    std::vector<PartInfo> all = parts_in_2d();
    for (PartInfo& info : parts_in_3d()) all.push_back(std::move(info));
    return all;
  }();
  return parts;
}

std::string_view to_string(Verdict verdict) {
  constexpr std::array<std::string_view, 3> kNames{"within", "outside", "no verdict"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string_view to_string(Origin origin) {
  constexpr std::array<std::string_view, 3> kNames{"computed", "simulated", "simulated and real"};
  return kNames[static_cast<std::size_t>(origin)];
}

void Part::claim(std::string quantity, std::string paper, std::string ours, bool holds, std::string remark) {
  rows.push_back({std::move(quantity), std::move(paper), std::move(ours), verdict_of(holds), std::move(remark)});
}

void Part::state(std::string quantity, std::string paper, std::string ours, std::string remark) {
  rows.push_back({std::move(quantity), std::move(paper), std::move(ours), Verdict::kOpen, std::move(remark)});
}

void go_on(const PartContext& place) {
  if (place.stop()) throw Error(ExitCode::kInterrupted, "interrupted");
}

void add_picture(Part& part, const PartContext& place, const Canvas& drawing, Picture picture, double scale) {
  go_on(place);
  write_file_atomically(place.folder + "/" + picture.file, drawing_bytes(drawing, picture.file, scale));
  part.pictures.push_back(std::move(picture));
}

Canvas titled_sheet(double width, double height, const std::string& title, const std::string& words) {
  Canvas canvas(width, height, title);
  canvas.rectangle({0.0, 0.0}, width, height, Fill{kLightTheme.page});
  canvas.text({24.0, 38.0}, title, {.size = 20.0, .is_bold = true});
  canvas.text({24.0, 60.0}, words, {.size = 13.0, .colour = ink::kQuiet});
  return canvas;
}

void add_view(Part& part, const PartContext& place, const ViewOrder& order, Picture picture) {
  go_on(place);
  RenderOptions options = order.options;
  options.inputs = order.inputs;
  options.view = order.view;
  options.size = order.size;
  options.quiet = true;
  std::vector<RenderSource> sources;
  sources.reserve(order.inputs.size());
  for (const std::string& input : order.inputs) sources.emplace_back(input);
  RenderStudio studio(options, sources);
  std::optional<PictureSize> size;
  if (!order.size.empty()) size = size_of(order.size);
  add_picture(part, place, (studio.*render_view(order.view).draw)(size), std::move(picture));
}

std::string length_with_unit(double length_m) {
  const double size_m = std::abs(length_m);
  if (size_m < 0.01) return fmt::format("{:.2f} mm", 1000.0 * length_m);
  if (size_m < 1.0) return fmt::format("{:.2f} cm", 100.0 * length_m);
  return fmt::format("{:.2f} m", length_m);
}

}  // namespace gdtslam::reproduce
