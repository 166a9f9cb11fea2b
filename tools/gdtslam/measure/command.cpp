// gdtslam measure: boxes and planes of a cloud with their dimensions and uncertainty.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/inputs/given_files.hpp"
#include "engine/runs/measuring/measure_table.hpp"
#include "gdtslam/cloud/box.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/drawings/measure_drawing.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kMostPoints = 200'000'000;

struct MeasureCommand {
  MeasureJob job;
  PlaneSearch search;            ///< of planes and of the faces of boxes: thickness, trials, seed and number of planes
  double gap_m = 0.0;            ///< 0: as each search has it
  std::uint32_t min_points = 0;  ///< likewise
  bool json = false;
  std::string viewpoint;
  std::string csv;
  std::string picture;
};

// "x,y,z", each with its unit, in the coordinates of the cloud's file.
Point3 viewpoint_of(const std::string& text) {
  std::array<std::string, 3> words;
  std::size_t count = 0;
  for (const char c : text + ',') {
    if (c == ',') {
      ++count;
    } else if (count < words.size()) {
      words[count] += c;
    }
  }
  if (count != words.size())
    throw UsageError("--viewpoint: '" + text + "' is not X,Y,Z, for example 0,0,30cm, nor none");
  Point3 point;
  for (std::size_t k = 0; k < words.size(); ++k) {
    double& length_m = point[static_cast<Eigen::Index>(k)];
    length_m = quantity_of("--viewpoint", words[k], Unit::kMetre);
    // Beyond, no grid of the earth.
    if (!(std::abs(length_m) <= 1e9)) throw UsageError("--viewpoint: " + words[k] + " is not between -1e9 and 1e9 m");
  }
  return point;
}

// What the command line asks for, checked before the cloud is read.
MeasureJob job_of(const MeasureCommand& command) {
  MeasureJob job = command.job;
  for (PlaneSearch* const search : {&job.box_search.planes, &job.plane_search}) {
    search->thickness_m = command.search.thickness_m;
    search->max_planes = command.search.max_planes;
    search->trials = command.search.trials;
    search->seed = command.search.seed;
    if (command.gap_m > 0.0) search->gap_m = command.gap_m;
    if (command.min_points > 0) search->min_points = command.min_points;
  }
  BoxSearch& boxes = job.box_search;
  boxes.min_face_points = boxes.planes.min_points;
  if (boxes.min_size_m >= boxes.max_size_m) {
    throw UsageError(fmt::format("--min-size {}m is not below --max-size {}m", boxes.min_size_m, boxes.max_size_m));
  }
  job.finds_viewpoint = command.viewpoint.empty();
  if (!command.viewpoint.empty() && command.viewpoint != "none") job.viewpoint = viewpoint_of(command.viewpoint);
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

int run_measure(const MeasureCommand& command) {
  if (!command.job.boxes && !command.job.planes) throw UsageError("say what to measure: --boxes, --planes or both");
  if (command.job.boxes && command.job.planes && !command.csv.empty()) {
    throw UsageError("--csv writes one table: ask for --boxes or for --planes");
  }
  if (!command.picture.empty()) check_drawing_file("--picture", command.picture);
  WrittenFiles written({command.job.cloud});
  written.add("--csv", command.csv);
  written.add("--picture", command.picture);
  MeasureJob job = job_of(command);
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
  if (!command.csv.empty()) files.add(command.csv).write(as_csv(measured));
  if (!command.picture.empty()) {
    files.add(command.picture).write(drawing_bytes(drawing_of(measured, cloud), command.picture, kDensePng));
  }
  files.commit();
  print_result(command.json ? json_text(as_json(measured)) : as_text(measured));
  return static_cast<int>(ExitCode::kDone);
}

void add_search_options(CLI::App& command, MeasureCommand& chosen, CLI::Option* boxes) {
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
  add_count_option(command, "--max-planes", chosen.search.max_planes, 1,
                   "Number of planes at most, of which the largest are taken")
      ->capture_default_str();
  add_count_option(command, "--trials", chosen.search.trials, 1, "Random trials for each plane at most")
      ->capture_default_str();
  add_count_option(command, "--seed", chosen.search.seed, 0, "Seed of the random trials")->capture_default_str();
}

}  // namespace

void add_measure_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<MeasureCommand>();
  CLI::App* command = add_command(app, "measure", "Boxes and planes of a 3D cloud, with their dimensions");
  command
      ->add_option("cloud", chosen->job.cloud, "Folder of a run with a cloud, or a cloud: .ply or .pcd, plain or gzip")
      ->required()
      ->type_name("RUN|CLOUD");
  CLI::Option* const boxes = command->add_flag("--boxes", chosen->job.boxes, "Upright boxes: width, depth, height");
  command->add_flag("--planes", chosen->job.planes, "The largest planes");
  add_search_options(*command, *chosen, boxes);
  command->add_option("--csv", chosen->csv, "Write a table of the boxes or of the planes")->type_name("FILE");
  command
      ->add_option("--picture,--svg", chosen->picture,
                   "Write a top view of the boxes with their dimensions: .svg, .png or .pdf")
      ->type_name("FILE")
      ->needs(boxes);
  command->add_flag("--json", chosen->json, "Print JSON");
  command->footer(
      "A value stands with its standard deviation, and whether both of its ends were seen. Map with cloud.voxel=0:\n"
      "the edges of a box are told by all beams that met it or passed it. docs/measuring.md says how.\n"
      "\n"
      "Examples:\n"
      "  gdtslam measure run --boxes\n"
      "  gdtslam measure run --planes\n"
      "  gdtslam measure run --boxes --projection --picture boxes.svg --csv boxes.csv\n"
      "  gdtslam measure room.pcd --boxes --viewpoint 0,0,1.2m --json\n"
      "  gdtslam measure room.pcd --planes --thickness 5cm --min-points 1000");
  command->callback([chosen, &context] { context.run = [chosen] { return run_measure(*chosen); }; });
}

}  // namespace gdtslam
