// gdtslam edit: prepares a map for others: rotates, crops, cleans and georeferences it.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/runs/edits/edit_run.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

struct EditCommand {
  EditRequest request;
  std::string origin;
  std::string crop;
  std::vector<std::string> erased;
  std::vector<std::string> points;
  bool no_pictures = false;
  bool json = false;
  bool quiet = false;
};

/// Report with a line for each step.
struct StepText {
  std::string operator()(const FrameEdit& edit) const {
    const Pose2& T = edit.T_before_after;
    std::string text = fmt::format("origin at {:.3f},{:.3f} of the map before, x axis at {:.4f} deg", T.x_m, T.y_m,
                                   deg_from_rad(T.theta_rad));
    if (edit.by == FrameEdit::By::kWalls) {
      text += fmt::format(", along {:.0f} % of the walls", 100.0 * edit.walls_share);
    }
    if (edit.by == FrameEdit::By::kNorth) text += ", y axis north";
    return text + '\n';
  }
  std::string operator()(const EraseEdit& edit) const {
    return fmt::format("erased: a polygon of {} corners\n", edit.region.corners_m.size());
  }
  std::string operator()(const CropEdit& edit) const {
    return fmt::format("cropped to {:g},{:g} .. {:g},{:g}\n", edit.low_m.x(), edit.low_m.y(), edit.high_m.x(),
                       edit.high_m.y());
  }
  std::string operator()(const GeoreferenceEdit& edit) const {
    std::string text = fmt::format(
        "georeferenced by {} points: residuals of {:.3f} m (root of the mean square), scale "
        "{:.5f}\n",
        edit.points.size(), edit.fit.rms_m, edit.fit.scale);
    for (std::size_t k = 0; k < edit.points.size(); ++k) {
      const PointPair& p = edit.points[k];
      text += fmt::format("  {:.3f},{:.3f} = {:.3f},{:.3f}  off {:.3f} m\n", p.map_m.x(), p.map_m.y(), p.world_m.x(),
                          p.world_m.y(), edit.fit.residuals_m[k]);
    }
    return text;
  }
  std::string operator()(const WorldFileEdit& /*edit*/) const { return "map.png and map.pgw for a GIS\n"; }
};

std::string edit_text(const EditRequest& request, const EditOutcome& outcome) {
  std::string text;
  for (const EditStep& step : outcome.steps) text += std::visit(StepText{}, step);
  if (outcome.readings > 0) text += fmt::format("{} readings taken out of the keyframes\n", outcome.readings);
  if (outcome.scans > 0) {
    text +=
        fmt::format("map.pgm cast anew from {} {}\n", outcome.scans, outcome.is_of_keyframes ? "keyframes" : "scans");
  }
  if (outcome.tiles > 0) text += fmt::format("{} in the folder tiles\n", plural(outcome.tiles, "tile"));
  return text + fmt::format("results in {}\n", printable(request.folder));
}

EditRequest make_request(const EditCommand& command) {
  EditRequest request = command.request;
  if (!command.origin.empty()) request.origin = parse_origin(command.origin);
  if (!command.crop.empty()) request.crop = parse_rectangle(command.crop);
  for (const std::string& text : command.erased) request.erased.push_back(parse_region(text));
  for (const std::string& text : command.points) {
    for (const PointPair& point : parse_point_pairs(text)) request.points.push_back(point);
  }
  request.with_pictures = !command.no_pictures;
  request.stop = [] { return interrupted(); };
  return request;
}

int edit(const EditCommand& command) {
  EditRequest request = make_request(command);
  WrittenFiles({request.run}, request.replace_foreign_files).add_folder("--output", request.folder);
  TerminalLine line(command.quiet);
  request.progress = [&line](std::string_view step, double share) {
    line.draw([&](double) { return fmt::format("{:4.0f} %  {}", 100.0 * share, step); });
  };
  const EditOutcome outcome = edit_run(request);
  line.clear();
  if (!command.quiet) print_warnings(outcome.warnings);
  if (command.json) {
    print_result(outcome.edits);
  } else if (!command.quiet) {
    print_result(edit_text(request, outcome));
  }
  return static_cast<int>(ExitCode::kDone);
}

void add_frame_options(CLI::App& command, EditCommand& options) {
  command.add_flag("--rotate-to-walls", options.request.along_walls,
                   "Turn the map so that most walls run along its axes, by less than 45 degrees");
  command
      .add_option("--origin", options.origin,
                  "This pose of RUN's map becomes the origin: metres, and degrees of the x axis, which may be left out")
      ->type_name("X,Y[,THETA]");
  command
      .add_option("--georeference", options.points,
                  "A point of RUN's map and where it is in the world, x,y=EASTING,NORTHING in metres, or a file with "
                  "one a line; two points or more")
      ->type_name("POINT|FILE")
      ->allow_extra_args(false);
  command.add_flag("--north-up", options.request.north_up, "Turn the map so that y is the north of --georeference");
}

void add_region_options(CLI::App& command, EditCommand& options) {
  command
      .add_option("--crop", options.crop, "Only this rectangle is left, between two corners in metres of the new map")
      ->type_name("X0,Y0,X1,Y1");
  command
      .add_option("--erase", options.erased,
                  "Take out what was seen in this polygon: 'x,y x,y x,y ...' in metres of the new map, or a file with "
                  "a corner a line; may be given again")
      ->type_name("POLYGON|FILE")
      ->allow_extra_args(false);
}

constexpr const char* kEditFooter =
    "RUN is left alone. Its keyframes are moved, and every output is made anew from them in one new frame: map.pgm,\n"
    "gdt.png, trajectory.tum, keyframes.bin.gz, graph.g2o, covariance.csv, pictures and report.json. edits.json has "
    "the\n"
    "steps with their numbers. --again does them once more after the next session, with the same numbers, before the\n"
    "steps that are named with it. --origin and --georeference are read in RUN's frame, --crop and --erase in the new "
    "one.\n"
    "Runs are those of flat lasers, and sites of 'gdtslam merge'.\n"
    "\n"
    "Examples:\n"
    "  gdtslam edit run --rotate-to-walls -o straight\n"
    "  gdtslam edit straight --erase '3,1 4,1 4,2' --crop -5,-5,20,15 -o clean\n"
    "  gdtslam edit run --georeference 0.2,1.5=455012.1,5411930.4 --georeference 31,8.1=455040.9,5411941.2 \\\n"
    "    --world-file -o placed\n"
    "  gdtslam edit run2 --again clean/edits.json -o clean2\n"
    "  gdtslam edit run --tiles -o tiled";

}  // namespace

void add_edit_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<EditCommand>();
  CLI::App* command = add_command(app, "edit", "Turn, crop, clean and georeference the map of a run");
  command->add_option("run", options->request.run, "Run folder of 'gdtslam map', or site of 'gdtslam merge'")
      ->required()
      ->type_name("RUN");
  command->add_option("-o,--output", options->request.folder, "Folder of the results, another than RUN")
      ->required()
      ->type_name("DIR");
  command->add_option("--again", options->request.again, "Do the steps of this edits.json first")->type_name("FILE");
  add_frame_options(*command, *options);
  add_region_options(*command, *options);
  command->add_flag("--world-file", options->request.with_world_file,
                    "Write map.png and map.pgw too, an ESRI world file, for a GIS");
  command->add_flag("--tiles", options->request.with_tiles,
                    "Write the map in tiles of 2048 cells a side too, maps in themselves, in the folder DIR/tiles");
  add_force_option(*command, options->request.replace_foreign_files);
  command->add_flag("--no-pictures", options->no_pictures, "Do not write overview.png and graph.png");
  command->add_flag("--json", options->json, "Print edits.json on standard output");
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(kEditFooter);
  command->callback([options, &context] {
    context.run = [options] { return edit(*options); };
    context.when_out_of_memory = kSmallerMap;
  });
}

}  // namespace gdtslam
