// gdtslam render: pictures, films and pages of a run, a cloud, a linkage, a map or a trajectory, without a display.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/json_file.hpp"
#include "gdtslam/core/error.hpp"
#include "studio.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"
#include "views.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const RenderResult& result) {
  Json json{{"file", result.file}, {"output", to_string(result.kind)}};
  json["view"] = result.view.empty() ? Json() : Json(result.view);
  json["as"] = result.as.empty() ? Json() : Json(result.as);
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

// Reports mistakes that show without reading an input.
void check_options(const RenderOptions& options) {
  if (!options.output.empty()) read_output_kind(options.output);
  if (!options.view.empty()) render_view(options.view, options.as);
  if (!options.size.empty()) read_size(options.size);
  if (!options.seconds.empty()) quantity_of("--seconds", options.seconds, Unit::kSecond);
  read_viewpoint(options.from);
  read_hidden(options.hide);
  read_time_range(options.time);
  read_cloud_look(options);
}

int list_views(const RenderOptions& options, const std::vector<RenderSource>& sources) {
  const unsigned parts = render_parts(options, sources);
  const RenderView* const still = default_view(parts, false);
  const RenderView* const film = default_view(parts, true);
  Json all = Json::array();
  std::string text;
  for (const RenderView& view : render_views()) {
    const std::string missing = missing_parts(view, parts);
    const bool is_default = &view == still || &view == film;
    all.push_back({{"view", view.name},
                   {"as", view.as.empty() ? Json() : Json(view.as)},
                   {"doc", view.doc},
                   {"available", missing.empty()},
                   {"missing", missing.empty() ? Json() : Json(missing)},
                   {"can_be_film", view.moves()},
                   {"default", &view == still && &view == film ? Json("both")
                               : &view == still                ? Json("still")
                               : &view == film                 ? Json("film")
                                                               : Json()}});
    if (!missing.empty()) continue;
    const std::string marks = fmt::format("{}{}", view.moves() ? "film" : "", is_default ? " *" : "");
    text += fmt::format("{:<21} {:<7} {}\n", view.words(), marks, view.doc);
  }
  if (text.empty()) {
    text = fmt::format("{} has no view without more\n", to_string(sources.front().kind()));
  } else {
    text += "film: can be .mp4, .gif or frames; *: drawn if no --view is given, as a still or as a film\n";
  }
  if ((parts & part::kTrajectory) != 0 && (parts & part::kTruth) == 0) {
    text += "with --reference or --relations FILE also errors; with --reference FILE errors --as path\n";
  }
  print_result(options.json ? json_text(all) : text);
  return static_cast<int>(ExitCode::kDone);
}

void require_inputs_fit(const RenderOptions& options) {
  const bool is_compared = options.view.empty() || render_view(options.view, options.as).compares();
  const bool are_paths = std::all_of(options.inputs.begin(), options.inputs.end(), [](const std::string& input) {
    const RenderKind kind = kind_of_input(input);
    return kind == RenderKind::kRun || kind == RenderKind::kTrajectory;
  });
  if (options.inputs.size() == 1 || (is_compared && are_paths)) return;
  throw UsageError(
      "several inputs are compared by the views trajectory and errors, and have to be runs or trajectories");
}

int render_inputs(const RenderOptions& options) {
  check_options(options);
  require_inputs_fit(options);
  if (!options.output.empty()) require_writable(options, options.output);
  std::vector<RenderSource> sources;
  for (const std::string& input : options.inputs) sources.emplace_back(input);
  if (!options.linkage.empty()) sources.front().set_linkage(options.linkage);
  if (options.lists_views) return list_views(options, sources);
  const RenderResult result = render(options, sources);
  if (options.json) {
    print_result(json_text(as_json(result)));
  } else if (!options.quiet) {
    print_result(as_text(result));
  }
  return static_cast<int>(ExitCode::kDone);
}

/// Adds an option to a group of the help.
template <class Value>
CLI::Option* add(CLI::App& command, const char* group, const char* name, Value& value, const std::string& doc,
                 const char* type) {
  return command.add_option(name, value, doc)->type_name(type)->group(group);
}

void add_look_options(CLI::App& command, RenderOptions& chosen) {
  constexpr const char* kLook = "Look";
  add(command, kLook, "--size", chosen.size, "Size of the picture in pixels [1600x1000; films 1280x720, .gif 640x360]",
      "WxH");
  add(command, kLook, "--title", chosen.title, "Title of the picture [the input's name]", "TEXT");
  offer_words(add(command, kLook, "--from", chosen.from,
                  "Place of the camera of a cloud: " + listed(option_words("--from")) +
                      ", or eye and target in metres\nand the view angle in degrees, X,Y,Z,X,Y,Z[,ANGLE] [iso]",
                  "PLACE"),
              option_words("--from"));
  offer_words(add(command, kLook, "--colour", chosen.colour,
                  "Colour of a cloud's points: " + listed(option_words("--colour")) +
                      "\n[height; with --reference CLOUD distance]",
                  "NAME"),
              option_words("--colour"));
  offer_words(add(command, kLook, "--colour-map", chosen.colour_map,
                  "Colours from low to high: " + listed(colour_map_names()), "NAME"),
              colour_map_names());
  add(command, kLook, "--range", chosen.range,
      "Ends of the colours with their units, as 0m:2.5m [1st and 99th percentile]", "MIN:MAX");
  offer_words(add(command, kLook, "--background", chosen.background,
                  "Background: " + listed(option_words("--background")) +
                      " (.png, .svg, .pdf and frames) [clouds dark, all else light]",
                  "NAME"),
              option_words("--background"));
  offer_words(add(command, kLook, "--hide", chosen.hide,
                  "Parts to leave out, with commas between them: " + listed(option_words("--hide")) +
                      "\n[from above the ceiling, unless none]",
                  "PARTS"),
              option_words("--hide"));
}

void add_film_options(CLI::App& command, RenderOptions& chosen) {
  constexpr const char* kFilm = "Film";
  add(command, kFilm, "--fps", chosen.frames_per_s, "Frames a second, of a .gif 50 at most [25]", "N")
      ->check(CLI::Range(0.1, 240.0));
  add(command, kFilm, "--seconds", chosen.seconds,
      "Time that a film plays [around a cloud 8, from the robot 20, scan real time up to 20, scene 4,\nloops 12]",
      "TIME");
  add(command, kFilm, "--time", chosen.time, "Stretch of the log in the view scan, from its first pose: 20s:60s",
      "FROM:TO");
}

void add_data_options(CLI::App& command, RenderOptions& chosen) {
  constexpr const char* kData = "Data";
  add(command, kData, "--reference", chosen.reference,
      "A cloud in the same frame, for distances up to 1 m or the end of --range; the true trajectory, TUM,\nfor "
      "trajectory and errors; a run for either",
      "FILE");
  add(command, kData, "--relations", chosen.relations, "Verified relations for errors, as evaluate reads them", "FILE")
      ->excludes("--reference");
  add(command, kData, "--points", chosen.points,
      "Thin a cloud to at most N points [films and .html 500,000, films from the robot and .glb 1,000,000,\nstills of "
      "all of it as many as pixels or 1,000,000, else all]",
      "N")
      ->transform(without_leading_zeros())
      ->check(whole_number_from(1));
  add(command, kData, "--linkage", chosen.linkage, "How the laser nods if the input does not say: preset or file",
      "NAME|FILE");
}

}  // namespace

void add_render_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<RenderOptions>();
  CLI::App* command = add_command(app, "render", "Pictures, films and pages of a run, cloud, linkage or map");
  command
      ->add_option(
          "input", chosen->inputs,
          "Run folder, cloud (.ply, .pcd), linkage (preset or file), map.yaml, gdt.yaml or trajectory (.tum),\n"
          "recognised by content; several runs for trajectory and errors")
      ->required()
      ->type_name("INPUT");
  command
      ->add_option(
          "-o,--output", chosen->output,
          "File, by its ending: .png .svg .pdf, films .mp4 .gif, frames DIR/, a page .html, the cloud .glb .ply\n"
          ".pcd, a linkage .glb [<name>-<view>.png here]")
      ->check([](const std::string& file) { return std::string(file.empty() ? "the file has no name" : ""); })
      ->type_name("FILE");
  CLI::Option* const view = command->add_option("--view", chosen->view, "What is drawn (see --list-views)");
  std::vector<std::string> views;
  std::vector<std::string> kinds;
  for (const RenderView& row : render_views()) {
    if (views.empty() || views.back() != row.name) views.emplace_back(row.name);
    if (!row.as.empty()) kinds.emplace_back(row.as);
  }
  offer_words(view->type_name("NAME"), std::move(views));
  offer_words(command
                  ->add_option("--as", chosen->as,
                               "Kind of a view: field intensity (default) or distance; errors box (default), cdf, "
                               "time or path")
                  ->type_name("KIND"),
              std::move(kinds));
  command->add_flag("--list-views", chosen->lists_views, "List the views that this input has");
  add_look_options(*command, *chosen);
  add_film_options(*command, *chosen);
  add_data_options(*command, *chosen);
  add_force_option(*command, chosen->force);
  command->add_flag("--json", chosen->json, "Print what was written as JSON");
  command->add_flag("-q,--quiet", chosen->quiet, "Print errors only");
  command->footer(
      "Without a view the most telling one is drawn: the cloud of a run that has one, else its map. From above a\n"
      "ceiling would hide the rooms, so it is left out but from front and side. A film's .png is one of its frames.\n"
      "\n"
      "Examples:\n"
      "  gdtslam render office                                    the run folder 'office': its cloud, or its map\n"
      "  gdtslam render office --from top --hide floor -o top.png --size 3840x2160\n"
      "  gdtslam render office -o office.html                     a page to turn the cloud in, without a network\n"
      "  gdtslam render office -o orbit.mp4 --seconds 10s\n"
      "  gdtslam render paper-b -o paper-b.gif                    the linkage through one turn\n"
      "  gdtslam render a b --view errors --as cdf --relations intel.relations.gz -o errors.svg");
  command->callback([chosen, &context] {
    context.run = [chosen] { return render_inputs(*chosen); };
    context.when_out_of_memory = "a smaller --size or fewer --points need less";
  });
}

}  // namespace gdtslam
