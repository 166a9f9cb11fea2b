// Boxes and planes of a cloud with their dimensions and uncertainty.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "evaluate.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/drawings/measure_drawing.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kMostPoints = 200'000'000;

constexpr const char* kGroup = "Boxes and planes";

// Parses "x,y,z", each with its unit, in the coordinates of the cloud's file.
Point3 parse_viewpoint(const std::string& text) {
  const std::vector<std::string> words = words_between_commas(text);
  if (words.size() != 3) throw UsageError("--viewpoint: '" + text + "' is not X,Y,Z, for example 0,0,30cm, nor none");
  Point3 point;
  for (std::size_t k = 0; k < words.size(); ++k) {
    double& length_m = point[static_cast<Eigen::Index>(k)];
    length_m = quantity_of("--viewpoint", words[k], Unit::kMetre);
    // No grid on earth reaches farther.
    if (!(std::abs(length_m) <= 1e9)) throw UsageError("--viewpoint: " + words[k] + " is not between -1e9 and 1e9 m");
  }
  return point;
}

// The job from the command line, checked before the cloud is read.
MeasureJob make_measure_job(const EvaluateOptions& options) {
  const MeasureOptions& chosen = options.measure;
  MeasureJob job = chosen.job;
  job.cloud = options.file;
  for (PlaneSearch* const search : {&job.box_search.planes, &job.plane_search}) {
    search->thickness_m = chosen.search.thickness_m;
    if (chosen.gap_m > 0.0) search->gap_m = chosen.gap_m;
    if (chosen.min_points > 0) search->min_points = chosen.min_points;
  }
  BoxSearch& boxes = job.box_search;
  boxes.min_face_points = boxes.planes.min_points;
  if (boxes.min_size_m >= boxes.max_size_m) {
    throw UsageError(fmt::format("--min-size {}m is not below --max-size {}m", boxes.min_size_m, boxes.max_size_m));
  }
  job.finds_viewpoint = chosen.viewpoint.empty();
  if (!chosen.viewpoint.empty() && chosen.viewpoint != "none") job.viewpoint = parse_viewpoint(chosen.viewpoint);
  return job;
}

Measurement measure(const MeasureJob& job, const Cloud& cloud) {
  Measurement measured = measure_cloud(job, cloud);
  if (job.boxes && job.finds_viewpoint && !measured.viewpoint) {
    print_remark(
        "the cloud does not tell where one standing scanner was; ends of faces are measured without it, less exactly "
        "(--viewpoint X,Y,Z says where it was)");
  }
  return measured;
}

}  // namespace

void add_measure_options(CLI::App& command, MeasureOptions& chosen) {
  const std::size_t before = command.get_options().size();
  CLI::Option* const boxes =
      command.add_flag("--boxes", chosen.job.boxes, "Measure upright boxes: width, depth, height");
  CLI::Option* const planes = command.add_flag("--planes", chosen.job.planes, "Measure the largest planes");
  for (const char* truth : {"--relations", "--reference", "--scene", "--hits", "--trajectory", "--within"}) {
    boxes->excludes(truth);
    planes->excludes(truth);
  }
  command
      .add_option("--viewpoint", chosen.viewpoint,
                  "Where the scanner stood, or none [found from the elevations of the points]")
      ->type_name("X,Y,Z")
      ->needs(boxes);
  command
      .add_flag("--projection", chosen.job.box_search.is_projection, "Faces as lines of the projection to the floor")
      ->needs(boxes);
  BoxSearch& box = chosen.job.box_search;
  const auto add_length = [&command](const char* name, double& length_m, const QuantityBounds& bounds,
                                     const char* doc) {
    return add_quantity_option(command, name, length_m, Unit::kMetre, bounds, doc);
  };
  constexpr QuantityBounds kSizes{1e-2, 100.0};
  add_length("--min-size", box.min_size_m, kSizes, "Smallest width and height of a box")
      ->needs(boxes)
      ->default_str("10cm");
  add_length("--max-size", box.max_size_m, kSizes, "Largest width and height of a box")
      ->needs(boxes)
      ->default_str("1.5m");
  add_length("--thickness", chosen.search.thickness_m, {1e-3, 1.0},
             "A point farther from a plane is not on it; about three times the noise")
      ->default_str("3cm");
  add_length("--gap", chosen.gap_m, {1e-3, 10.0},
             "Points of one plane have a neighbour this close [10cm for boxes, 25cm for planes]");
  add_count_option(command, "--min-points", chosen.min_points, 3,
                   "Fewest points of a plane or a box's face [50 for boxes, 200 for planes]");
  command
      .add_option("--picture,--svg", chosen.picture,
                  "Write a top view of the boxes with their dimensions: .svg, .png or .pdf")
      ->type_name("FILE")
      ->needs(boxes);
  const std::vector<CLI::Option*> options = command.get_options();
  for (std::size_t k = before; k < options.size(); ++k) options[k]->group(kGroup);
}

int measure_boxes_and_planes(const EvaluateOptions& options) {
  const MeasureOptions& chosen = options.measure;
  if (chosen.job.boxes && chosen.job.planes && !options.csv.empty()) {
    throw UsageError("--csv writes one table: ask for --boxes or for --planes");
  }
  if (!chosen.picture.empty()) check_drawing_file("--picture", chosen.picture);
  WrittenFiles written({options.file}, options.force);
  written.add("--csv", options.csv);
  written.add("--picture", chosen.picture);
  MeasureJob job = make_measure_job(options);
  std::optional<RunReader> run;
  job.cloud = given_cloud(job.cloud, run);
  std::uint64_t skipped = 0;
  const auto read = [&] { return read_cloud(job.cloud, kMostPoints, &skipped, &job.origin_m); };
  const Cloud cloud = run ? run->files().unless_changed(read) : read();
  remark_origin(job.cloud, job.origin_m);
  if (skipped > 0)
    print_remark(fmt::format("warning: {} points of {} are not finite and left out", skipped, job.cloud));
  if (cloud.empty()) throw InputError({job.cloud, 0}, "holds no point to measure");
  const Measurement measured = measure(job, cloud);
  AtomicFileSet files;
  if (!options.csv.empty()) files.add(options.csv).write(as_csv(measured));
  if (!chosen.picture.empty()) {
    files.add(chosen.picture).write(drawing_bytes(draw_measurement(measured, cloud), chosen.picture, kDensePng));
  }
  files.commit();
  print_result(options.json ? json_text(as_json(measured)) : as_text(measured));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace gdtslam
