// Figure 12: three boxes of known width, measured in the 3D map and in its projection to the floor.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "engine/runs/measuring/measure_table.hpp"
#include "tools/gdtslam/drawings/measure_drawing.hpp"
#include "tools/gdtslam/pictures/source.hpp"
#include "tools/lab/reproduce/drives.hpp"
#include "tools/lab/reproduce/paper.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {
namespace {

/// Widths of the paper, the widest first, and the heights of the scene, for which it has no numbers; centimetres.
struct BoxOfPaper {
  double true_cm = 0.0;
  double paper_cm = 0.0;
  double height_cm = 0.0;
};
constexpr std::array<BoxOfPaper, 3> kBoxes{{{58.29, 57.5, 80.0}, {34.35, 34.8, 70.0}, {25.2, 24.8, 60.0}}};

// Beside and above the scanner, towards the boxes.
constexpr const char* kCamera = "-0.5,-0.6,1.35,1.9,0,0.62,48";

// The three whose widths come nearest, so that a piece of wall beside them is no box of the paper's.
const MeasuredBox* box_near(const Measurement& measured, double width_cm) {
  const auto off = [width_cm](const MeasuredBox& box) { return std::abs(100.0 * box.width.value_m - width_cm); };
  const auto nearest = std::min_element(measured.boxes.begin(), measured.boxes.end(),
                                        [&off](const MeasuredBox& a, const MeasuredBox& b) { return off(a) < off(b); });
  constexpr double kSame_cm = 4.0;
  return nearest == measured.boxes.end() || off(*nearest) > kSame_cm ? nullptr : &*nearest;
}

Row size_row(const std::string& quantity, const std::string& paper, const Dimension* found, double true_cm,
             double paper_mm, const std::string& rule) {
  if (found == nullptr) return {quantity, paper, "not found", Verdict::kOutside, rule};
  const double off_mm = std::abs(1000.0 * found->value_m - 10.0 * true_cm);
  return {quantity, paper, fmt::format("{:.2f} \u00b1 {:.2f} cm", 100.0 * found->value_m, 100.0 * found->sigma_m),
          verdict_of(off_mm <= paper_mm), fmt::format("off by {:.2f} mm; {}", off_mm, rule)};
}

Measurement measured_in(const Cloud& cloud, bool is_projection) {
  MeasureJob job;
  job.boxes = true;
  job.cloud = "three-boxes/cloud.ply";  // as the commands name it
  job.box_search.min_face_points = job.box_search.planes.min_points;
  job.box_search.is_projection = is_projection;
  return measure_cloud(job, cloud);
}

}  // namespace

std::vector<Row> box_rows(const Measurement& measured) {
  std::vector<Row> rows;
  for (const BoxOfPaper& box : kBoxes) {
    const MeasuredBox* const found = box_near(measured, box.true_cm);
    const double paper_mm = 10.0 * std::abs(box.paper_cm - box.true_cm);
    const std::string name =
        fmt::format("of the box of {} cm, {}", box.true_cm, measured.is_projection ? "projected" : "3D");
    const std::string rule = fmt::format("rule: not more than the paper\u2019s width, {:.1f} mm", paper_mm);
    rows.push_back(size_row("width " + name, fmt::format("{} cm", box.paper_cm),
                            found == nullptr ? nullptr : &found->width, box.true_cm, paper_mm, rule));
    if (measured.is_projection) continue;
    rows.push_back(size_row(fmt::format("height ({:.0f} cm) {}", box.height_cm, name),
                            fmt::format("width off by {:.1f} mm", paper_mm),
                            found == nullptr ? nullptr : &found->height, box.height_cm, paper_mm, rule));
  }
  return rows;
}

Part make_boxes(const PartContext& place) {
  const Drive drive = place.drives.drive("three-boxes");
  const std::string file = drive.run + "/cloud.ply";
  const Cloud cloud = read_whole_cloud(file, {});
  const Measurement solid = measured_in(cloud, false);
  place.progress(0.4);
  const Measurement projected = measured_in(cloud, true);
  place.progress(0.7);
  Part part;
  part.source = "The scene three-boxes, seed 1: boxes of the paper\u2019s true widths before the standing scanner.";
  RenderOptions look;
  look.title = "Three boxes";
  look.no_path = true;
  look.camera = kCamera;
  add_view(part, place, {.inputs = {file}, .view = "iso", .size = "1600x1000", .options = look},
           {"cloud.png", "(b) The 3D map of the three boxes before the far wall, from beside the scanner."});
  add_picture(part, place, drawing_of(solid, cloud),
              {"solid.svg", "Measured in the 3D map, seen from above: faces and where they end."});
  add_picture(part, place, drawing_of(projected, cloud),
              {"projection.svg", "(c) Measured in the projection to the floor."});
  part.rows = box_rows(solid);
  for (Row& row : box_rows(projected)) part.rows.push_back(std::move(row));
  part.notes.push_back(
      "The simulated laser has 1 cm of noise and none of the biases of a real one (dark surfaces, grazing beams, a "
      "warm-up); the paper\u2019s errors of 4 to 8 mm contain those.");
  part.by_hand = Drives::commands_of("three-boxes");
  part.by_hand.push_back("gdtslam measure three-boxes/cloud.ply --boxes --picture solid.svg");
  part.by_hand.push_back(fmt::format("gdtslam render three-boxes/cloud.ply --view iso --no-path --camera={}", kCamera));
  part.by_hand.push_back("gdtslam measure three-boxes/cloud.ply --boxes --projection --picture projection.svg");
  return part;
}

}  // namespace gdtslam::reproduce
