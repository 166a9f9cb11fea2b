// gdtslam render: pictures, films and pages of a run, a cloud, a linkage, a map, a trajectory or a log, without a
// display.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "gdtslam/runs/map_log.hpp"
#include "run.hpp"
#include "tools/gdtslam/pictures/cloud_picture.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/folders.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/map_progress.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const RenderResult& result) {
  Json json{{"file", result.file}, {"output", to_string(result.kind)}};
  json["view"] = result.view.empty() ? Json() : Json(result.view);
  if (result.width > 0) json["size_px"] = {result.width, result.height};
  if (result.frames > 0) {
    json["frames"] = result.frames;
    json["film_s"] = result.film_s;
  }
  json["points"] = result.points;
  json["points_of"] = result.points_of;
  json["bytes"] = result.bytes;
  json["renderer"] = result.renderer;
  return json;
}

std::string bytes_text(std::uint64_t bytes) {
  constexpr double kKilo = 1000.0;
  const auto value = static_cast<double>(bytes);
  if (value < kKilo) return fmt::format("{} bytes", bytes);
  return value < kKilo * kKilo ? fmt::format("{:.0f} kB", value / kKilo)
                               : fmt::format("{:.1f} MB", value / kKilo / kKilo);
}

std::string as_text(const RenderResult& result) {
  std::string text = result.file + ":";
  if (!result.view.empty()) text += fmt::format(" view {},", result.view);
  if (result.width > 0) text += fmt::format(" {}x{} pixels,", result.width, result.height);
  if (result.frames > 0) text += fmt::format(" {} in {:.1f} s,", plural(result.frames, "frame"), result.film_s);
  if (result.points > 0) text += " " + points_text(result.points, result.points_of) + ",";
  return text + fmt::format(" {}\n", bytes_text(result.bytes));
}

// What nobody needs to wait for.
void check_options(const RenderOptions& options) {
  if (!options.output.empty()) output_kind_of(options.output);
  if (!options.view.empty()) render_view(options.view);
  if (!options.size.empty()) size_of(options.size);
  if (!options.camera.empty()) parse_camera(options.camera);
  if (!options.at.empty()) place_of(options.at);
  for (const auto& [name, text] :
       {std::pair{"--from", &options.from}, std::pair{"--to", &options.to}, std::pair{"--seconds", &options.seconds}}) {
    if (!text->empty()) time_of(name, *text);
  }
  cloud_look_of(options);
}

// The parts that views may use, those of a log before it is mapped too.
unsigned parts_of(const RenderOptions& options, std::vector<RenderSource>& sources, NodKind nods) {
  unsigned parts = has_truth(options) ? part::kTruth : 0U;
  if (has_true_path(options)) parts |= part::kTruePath;
  if (!sources.empty()) return parts | sources.front().parts();
  parts |= part::kMap | part::kField | part::kTrajectory | part::kGraph | part::kReplay;
  if (nods != NodKind::kNone) parts |= part::kCloud | part::kMount;
  return nods == NodKind::kEncoder ? parts | part::kLinkage : parts;
}

int list_views(const RenderOptions& options, RenderKind kind, unsigned parts) {
  const RenderView* const still = default_view(parts, false);
  const RenderView* const film = default_view(parts, true);
  Json all = Json::array();
  std::string text;
  for (const RenderView& view : render_views()) {
    const std::string missing = missing_parts(view, parts);
    const bool is_default = &view == still || &view == film;
    all.push_back({{"view", view.name},
                   {"doc", view.doc},
                   {"available", missing.empty()},
                   {"missing", missing.empty() ? Json() : Json(missing)},
                   {"can_be_film", view.moves()},
                   {"default", &view == still  ? Json("still")
                               : &view == film ? Json("film")
                                               : Json()}});
    if (!missing.empty()) continue;
    const std::string marks = fmt::format("{}{}", view.moves() ? "film" : "", is_default ? " *" : "");
    text += fmt::format("{:<12} {:<7} {}\n", view.name, marks, view.doc);
  }
  if (text.empty()) {
    text = fmt::format("{} has no view without more\n", to_string(kind));
  } else {
    text += "film: can be .mp4, .gif or frames; *: drawn where no --view is given, as a still or as a film\n";
  }
  if ((parts & part::kTrajectory) != 0 && (parts & part::kTruth) == 0) {
    text +=
        "with --reference or --relations FILE also errors-box, errors-cdf and errors-time; with --reference FILE "
        "errors-path\n";
  }
  print_result(options.json ? json_text(all) : text);
  return static_cast<int>(ExitCode::kDone);
}

MapOutcome map_into(const RenderOptions& options, const std::string& folder) {
  Settings settings;
  state_recording(options.recording, settings.log);
  MapRequest request{.logs = options.inputs,
                     .folder = folder,
                     .settings = settings,
                     .linkage = options.linkage,
                     .with_continue_file = !options.run_folder.empty(),
                     .replace_foreign_files = options.force,
                     .with_pictures = !options.run_folder.empty(),
                     .draw_cloud = draw_run_cloud};
  MapProgress progress(options.quiet);
  progress.follow(request);
  request.stop = [] { return interrupted(); };
  if (!options.quiet) request.warn = print_remark;
  BackendWhenNeeded backend({});
  MapResult result = map_logs(request, [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
  progress.clear();
  if (!options.quiet) print_remarks(result.outcome, options.run_folder);
  return std::move(result.outcome);
}

// A log is mapped first, into the folder of --run or one that goes when the picture is made.
class MappedLog {
 public:
  explicit MappedLog(const RenderOptions& options) {
    if (options.run_folder.empty()) temporary_.emplace("gdtslam-render");
    const std::string folder = temporary_ ? temporary_->path() + "/run" : options.run_folder;
    if (map_into(options, folder).interrupted) {
      throw Error(ExitCode::kInterrupted, temporary_ ? "interrupted while the log was mapped; nothing is written"
                                                     : "interrupted while the log was mapped; no picture is made");
    }
    folder_ = folder;
  }
  [[nodiscard]] const std::string& folder() const { return folder_; }

 private:
  std::optional<TemporaryFolder> temporary_;
  std::string folder_;
};

void require_inputs_fit(const RenderOptions& options, const std::vector<RenderKind>& kinds) {
  const bool is_compared = options.view.empty() || render_view(options.view).compares();
  const bool are_paths = std::all_of(kinds.begin(), kinds.end(), [](RenderKind kind) {
    return kind == RenderKind::kRun || kind == RenderKind::kTrajectory;
  });
  const bool are_logs =
      std::all_of(kinds.begin(), kinds.end(), [](RenderKind kind) { return kind == RenderKind::kLog; });
  if (kinds.size() > 1 && !(is_compared && are_paths) && !are_logs) {
    throw UsageError(
        "several inputs are compared by the views trajectory, errors-box, errors-cdf and errors-time, and have to be "
        "runs "
        "or trajectories; several logs are mapped as one");
  }
  if (!options.run_folder.empty() && !are_logs) throw UsageError("--run is for logs: where their run is kept");
  if (options.recording.are_stated() && !are_logs) {
    throw UsageError("--topic, --odom, --crank and --mount are for logs, which are mapped before they are drawn");
  }
}

int render_inputs(const RenderOptions& options) {
  check_options(options);
  std::vector<RenderKind> kinds;
  for (const std::string& input : options.inputs) kinds.push_back(kind_of_input(input));
  require_inputs_fit(options, kinds);
  if (!options.output.empty()) require_writable(options, options.output);
  WrittenFiles({}, options.force).add_folder("--run", options.run_folder);
  std::vector<RenderSource> sources;
  std::optional<MappedLog> mapped;
  if (kinds.front() == RenderKind::kLog) {
    if (options.lists_views) {
      LogConfig log;
      state_recording(options.recording, log);
      const ReadOptions log_options = read_options_of(log, false);
      return list_views(options, RenderKind::kRun,
                        parts_of(options, sources, nod_kind_of(options.inputs, log_options)));
    }
    mapped.emplace(options);
    sources.emplace_back(mapped->folder());
  } else {
    for (const std::string& input : options.inputs) sources.emplace_back(input);
    if (!options.linkage.empty()) sources.front().set_linkage(options.linkage);
  }
  if (options.lists_views) return list_views(options, kinds.front(), parts_of(options, sources, NodKind::kNone));
  const RenderResult result = render(options, sources);
  if (options.json) {
    print_result(json_text(as_json(result)));
  } else if (!options.quiet) {
    print_result(as_text(result));
  }
  return static_cast<int>(ExitCode::kDone);
}

/// An option of a group of the help.
template <class Value>
CLI::Option* add(CLI::App& command, const char* group, const char* name, Value& value, const std::string& doc,
                 const char* type) {
  return command.add_option(name, value, doc)->type_name(type)->group(group);
}
void add_flag(CLI::App& command, const char* group, const char* name, bool& value, const char* doc) {
  command.add_flag(name, value, doc)->group(group);
}

void add_look_options(CLI::App& command, RenderOptions& chosen) {
  constexpr const char* kLook = "Look";
  add(command, kLook, "--size", chosen.size, "Size of the picture in pixels [1600x1000; films 1280x720, .gif 640x360]",
      "WxH");
  add(command, kLook, "--title", chosen.title, "Title of the picture [the input's name]", "TEXT");
  add(command, kLook, "--colour", chosen.colour,
      "Colour of a cloud's points: height, elevation, time, scan, distance, plain\n[height; with --reference CLOUD "
      "distance]",
      "NAME");
  offer_words(command.get_option("--colour"), {"height", "elevation", "time", "scan", "distance", "plain"});
  add(command, kLook, "--colour-map,--colors", chosen.colour_map, "Colours from low to high: " + colour_map_names(),
      "NAME");
  std::vector<std::string> maps;
  for (const ColourMap& map : colour_maps()) maps.emplace_back(map.name());
  offer_words(command.get_option("--colour-map"), std::move(maps));
  add(command, kLook, "--range", chosen.range,
      "Ends of the colours with their units, as 0m:2.5m [1st and 99th percentile]", "MIN:MAX");
  add(command, kLook, "--camera", chosen.camera,
      "Camera of iso, top, front and side: eye and target in metres, view angle in degrees:\nX,Y,Z,X,Y,Z[,ANGLE]",
      "PLACE");
  add(command, kLook, "--point-size", chosen.point_px, "Size of a cloud's points in pixels [by their density]",
      "PIXELS")
      ->check(CLI::Range(0.1, 50.0));
  add_flag(command, kLook, "--dark", chosen.is_dark, "Draw on a dark background, as clouds are by themselves");
  add_flag(command, kLook, "--light", chosen.is_light, "Draw on a light background, as all but clouds is by itself");
  add_flag(command, kLook, "--transparent", chosen.is_transparent, "No background: .png, .svg, .pdf and frames");
  add_flag(command, kLook, "--no-floor", chosen.no_floor, "Leave out the floor of a cloud");
  add_flag(command, kLook, "--no-ceiling", chosen.no_ceiling,
           "Leave out the ceiling: from above it is left out anyway");
  add_flag(command, kLook, "--with-ceiling", chosen.with_ceiling, "Draw the ceiling from above too");
  add_flag(command, kLook, "--no-path", chosen.no_path, "Leave out path, keyframes and robot");
  add_flag(command, kLook, "--no-caption", chosen.no_caption, "Leave out title, scales and read-outs");
}

void add_film_options(CLI::App& command, RenderOptions& chosen) {
  constexpr const char* kFilm = "Film";
  add(command, kFilm, "--fps", chosen.frames_per_s, "Frames a second, of a .gif 50 at most [25]", "N")
      ->check(CLI::Range(0.1, 240.0));
  CLI::Option* const frames = add(command, kFilm, "--frames", chosen.frames, "Number of frames", "N");
  frames->transform(without_leading_zeros())->check(whole_number_from(1));
  add(command, kFilm, "--seconds", chosen.seconds,
      "Time that a film plays, in place of --frames [orbit 8, follow 20, scan real time up to 20, scene 4,\nloops 12]",
      "TIME")
      ->excludes(frames);
  add(command, kFilm, "--from", chosen.from, "Begin of the views scan and elevation, counted from the first pose",
      "TIME");
  add(command, kFilm, "--to", chosen.to, "End of the views scan and elevation, counted from the first pose", "TIME");
  add(command, kFilm, "--ffmpeg", chosen.ffmpeg, "The program that makes .mp4 and .gif [ffmpeg of PATH]", "FILE");
}

void add_data_options(CLI::App& command, RenderOptions& chosen) {
  constexpr const char* kData = "Data";
  add(command, kData, "--reference", chosen.reference,
      "A cloud in the same frame, for distances up to 1 m or the end of --range; the true trajectory, TUM,\nfor "
      "trajectory and errors-*; a run for either",
      "FILE");
  add(command, kData, "--relations", chosen.relations, "Verified relations for errors-*, as evaluate reads them",
      "FILE")
      ->excludes("--reference");
  add_flag(command, kData, "--angle", chosen.is_angle,
           "Show errors of the heading in errors-*, in place of those of the position");
  add(command, kData, "--at", chosen.at, "Middle of the view cells [the obstacle nearest to the field's middle]",
      "X,Y");
  add(command, kData, "--cells", chosen.cells, "Cells a side in the view cells, 60 at most [12]", "N")
      ->transform(without_leading_zeros())
      ->check(whole_number_from(1));
  add_flag(command, kData, "--squared", chosen.is_squared,
           "Show squared distances in the view cells, as figure 3 has them");
  add(command, kData, "--points", chosen.points,
      "Thin a cloud to at most N points [films 500,000, follow and .gltf\n1,000,000, .html 500,000, stills of all of "
      "it as "
      "many as pixels or 1,000,000,\nelse all]",
      "N")
      ->transform(without_leading_zeros())
      ->check(whole_number_from(1));
  add(command, kData, "--linkage", chosen.linkage, "How the laser nods, where the input does not say: preset or file",
      "NAME|FILE");
  add_recording_options(command, chosen.recording);
  add(command, kData, "--run", chosen.run_folder,
      "Folder in which the run of a log that is mapped for the picture is kept", "DIR");
}

}  // namespace

void add_render_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<RenderOptions>();
  CLI::App* command = add_command(app, "render", "Pictures, films and pages of a run, cloud, linkage, map or log");
  command
      ->add_option(
          "input", chosen->inputs,
          "Run folder, cloud (.ply, .pcd), linkage (preset or file), map.yaml, gdt.yaml,\ntrajectory (.tum) or "
          "log, told by content; several runs for trajectory and errors-*")
      ->required()
      ->type_name("INPUT");
  command
      ->add_option(
          "-o,--output", chosen->output,
          "File, by its ending: .png .jpg .svg .pdf, films .mp4 .gif, frames DIR/ or f%04d.png,\na page .html, the "
          "cloud .glb .gltf .ply .pcd, a linkage .glb .gltf\n[<name>-<view>.png here]")
      ->check([](const std::string& file) { return std::string(file.empty() ? "the file has no name" : ""); })
      ->type_name("FILE");
  CLI::Option* const view = command->add_option("--view", chosen->view, "What is drawn (see --list-views)");
  std::vector<std::string> views;
  for (const RenderView& row : render_views()) views.emplace_back(row.name);
  offer_words(view->type_name("NAME"), std::move(views));
  command->add_flag("--list-views", chosen->lists_views, "List the views that this input has");
  add_look_options(*command, *chosen);
  add_film_options(*command, *chosen);
  add_data_options(*command, *chosen);
  add_force_option(*command, chosen->force);
  command->add_flag("--json", chosen->json, "Print what was written as JSON");
  command->add_flag("-q,--quiet", chosen->quiet, "Print errors only");
  command->footer(
      "Without a view the most telling one is drawn: the cloud of a run that has one, else its map. From above a\n"
      "ceiling would hide the rooms, so iso, top, orbit and follow leave it out. A film's .png is one of its frames.\n"
      "\n"
      "Examples:\n"
      "  gdtslam render office                                    the run folder 'office': its cloud, or its map\n"
      "  gdtslam render office --view top --no-floor -o top.png --size 3840x2160\n"
      "  gdtslam render office -o office.html                     a page to turn the cloud in, without a network\n"
      "  gdtslam render office -o orbit.mp4 --seconds 10s\n"
      "  gdtslam render paper-b -o paper-b.gif                    the linkage through one turn\n"
      "  gdtslam render a b --view errors-cdf --relations intel.relations.gz -o errors.svg\n"
      "  gdtslam render drive.log --run drive                     maps the log first and keeps the run");
  command->callback([chosen, &context] {
    context.run = [chosen] { return render_inputs(*chosen); };
    context.when_out_of_memory = "a smaller --size or fewer --points need less";
  });
}

}  // namespace gdtslam
