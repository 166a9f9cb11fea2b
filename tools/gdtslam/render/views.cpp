#include "views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "files/film_writer.hpp"
#include "gdtslam/core/error.hpp"
#include "options.hpp"
#include "source.hpp"
#include "studio.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using namespace effect;
using Studio = RenderStudio;

constexpr unsigned kCompared = part::kTrajectory | part::kTruth;
constexpr unsigned kScene = kDark | kGround | kCaption;
constexpr unsigned kScan = kScene | kColour | kScale | kColourMap | kLevels | kTitle | kPoints | kLinkage | kTime;
constexpr unsigned kCloud = (kScan & ~kTime) | kPath | kDistances | kFrom;
constexpr unsigned kMap = kGround | kCaption | kPath | kTitle;
constexpr unsigned kErrorPlot = kTitle | kPlot | kReference | kRelations | kSeveral;

bool can_show(const RenderView& view, unsigned parts) { return (view.needs & ~parts) == 0; }

struct Ending {
  std::string_view extension;
  OutputKind kind;
};
constexpr std::array<Ending, 9> kEndings{{{".png", OutputKind::kPng},
                                          {".svg", OutputKind::kSvg},
                                          {".pdf", OutputKind::kPdf},
                                          {".mp4", OutputKind::kMp4},
                                          {".gif", OutputKind::kGif},
                                          {".html", OutputKind::kPage},
                                          {".glb", OutputKind::kGlb},
                                          {".ply", OutputKind::kCloud},
                                          {".pcd", OutputKind::kCloud}}};

/// Options with an effect on a view in this form; a file without a view depends on the form alone.
unsigned output_effects(const RenderView* view, OutputKind output, bool is_linkage) {
  if (is_linkage) return kTitle | kLinkage;
  if (output == OutputKind::kPage) return kTitle | kDistances | kPoints | kLinkage;
  if (output == OutputKind::kCloud) return kLevels | kPoints;
  if (output == OutputKind::kGlb) {
    return kColour | kScale | kColourMap | kLevels | kPath | kTitle | kDistances | kPoints;
  }
  return view->effects | (is_film(output) ? kFilm : 0U);
}

struct GivenOption {
  std::string_view name;
  bool is_given = false;
  unsigned effects = 0;   ///< any one of them is enough
  std::string_view fits;  ///< content that the option is for
};

std::vector<GivenOption> given_options(const RenderOptions& o, OutputKind output) {
  const bool colours_by_distance = o.colour.empty() || o.colour == "distance" || output == OutputKind::kPage;
  const unsigned reference = has_true_path(o) ? kReference : colours_by_distance ? kDistances : 0U;
  const Background background = read_background(o.background);
  const Hidden hidden = read_hidden(o.hide);
  return {
      {"--from", !o.from.empty(), kFrom, "the view cloud"},
      {"--colour", !o.colour.empty(), kColour, "clouds"},
      {"--colour-map", !o.colour_map.empty(), kColourMap, "clouds, distance fields and paths"},
      {"--range", !o.range.empty(), kScale, "clouds and errors --as path"},
      {"--background", background == Background::kDark, kDark, "scenes in 3D"},
      {"--background", background != Background::kDefault, kGround, "scenes, maps and fields"},
      {"--hide", hidden.floor || hidden.ceiling || hidden.nothing, kLevels, "clouds, which have floor and ceiling"},
      {"--hide path", hidden.path, kPath, "clouds, maps and fields"},
      {"--hide caption", hidden.caption, kCaption, "scenes, maps and fields"},
      {"--title", !o.title.empty(), kTitle, "pictures of runs and clouds, pages and .glb"},
      {"--fps", o.frames_per_s > 0.0, kFilm, "films"},
      {"--seconds", !o.seconds.empty(), kFilm, "films"},
      {"--time", !o.time.empty(), kTime, "the view scan"},
      {"--reference", !o.reference.empty(), reference,
       "a trajectory: the views trajectory and errors; a cloud: clouds coloured by distance"},
      {"--relations", !o.relations.empty(), kRelations, "the view errors as box, cdf or time"},
      {"--points", o.points > 0, kPoints, "clouds"},
      {"--linkage", !o.linkage.empty(), kLinkage, "pictures of clouds, the view scene, pages, and .glb of a linkage"},
  };
}

}  // namespace

std::string RenderView::words() const { return std::string(name) + (as.empty() ? "" : " --as ") + std::string(as); }

const std::vector<RenderView>& render_views() {
  static const std::vector<RenderView> views{
      {"cloud", "", "3D cloud; a film goes once around it, or with --from robot along the path", part::kCloud, kCloud,
       &Studio::cloud, 5, &Studio::cloud_film, Studio::kOrbit_s},
      {"scan", "", "the robot scanning, points appearing as they are measured (--time)",
       part::kCloud | part::kTrajectory | part::kMount, kScan, &Studio::poster_of_scan, 0, &Studio::scan_film,
       Studio::kLongestScan_s},
      {"map", "", "occupancy map, with the path where there is one", part::kMap, kMap | kColourMap, &Studio::map, 3},
      {"graph", "", "loops over the map, how sure each pose is, and what is not to be trusted",
       part::kMap | part::kGraph, kMap & ~kPath, &Studio::graph},
      {"loops", "", "the path as it was driven, and how loops bend it; a still has before and after side by side",
       part::kMap | part::kReplay, kMap & ~kPath, &Studio::before_and_after_loops, 1, &Studio::loops, 12.0},
      {"field", "intensity", "distance field as intensity, bright near obstacles", part::kField, kMap | kColourMap,
       &Studio::intensity, 2},
      {"field", "distance", "distance field in metres", part::kField, kMap | kColourMap, &Studio::distance},
      {"scene", "", "the mount's four bars and its laser; a film is one turn", part::kLinkage, kScene | kLinkage,
       &Studio::linkage, 1, &Studio::linkage_turn, 4.0},
      {"trajectory", "", "the path alone, coloured by time; over the truth (--reference), several side by side",
       part::kTrajectory, kMap | kColourMap | kReference | kSeveral, &Studio::trajectory, 1},
      {"errors", "box", "errors of the trajectory as box plot, runs side by side", kCompared, kErrorPlot,
       &Studio::errors_box, 6},
      {"errors", "cdf", "errors of the trajectory as distribution", kCompared, kErrorPlot, &Studio::errors_cdf},
      {"errors", "time", "errors of the trajectory over time", kCompared, kErrorPlot, &Studio::errors_time},
      {"errors", "path", "the path over the truth, coloured by its error (--reference)",
       part::kTrajectory | part::kTruePath, (kMap & ~kPath) | kColourMap | kReference | kScale, &Studio::errors_path},
  };
  return views;
}

const RenderView& render_view(const std::string& name, const std::string& as) {
  std::vector<std::string> names;
  std::vector<std::string> kinds;
  for (const RenderView& view : render_views()) {
    if (view.name == name && (as.empty() || view.as == as)) return view;
    if (names.empty() || names.back() != view.name) names.emplace_back(view.name);
    if (view.name == name && !view.as.empty()) kinds.emplace_back(view.as);
  }
  if (!kinds.empty()) {
    throw UsageError("--as: view " + name + " has no '" + as + "': it has " + listed(kinds) + did_you_mean(as, kinds));
  }
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    throw UsageError("--as: view " + name + " has one kind only");
  }
  throw UsageError("--view: there is no view '" + name + "'" + did_you_mean(name, names) +
                   " (--list-views shows those of this input)");
}

const RenderView* default_view(unsigned parts, bool is_film) {
  const RenderView* best = nullptr;
  for (const RenderView& view : render_views()) {
    if (!can_show(view, parts) || (is_film && !view.moves())) continue;
    if (view.rank > (best == nullptr ? 0 : best->rank)) best = &view;
  }
  return best;
}

std::string missing_parts(const RenderView& view, unsigned parts, std::string_view joint) {
  constexpr std::array<std::pair<unsigned, std::string_view>, 10> kNames{{
      {part::kMap, "map"},
      {part::kField, "distance field"},
      {part::kTrajectory, "trajectory"},
      {part::kCloud, "3D cloud"},
      {part::kLinkage, "linkage (--linkage NAME|FILE)"},
      {part::kMount, "linkage (--linkage NAME|FILE)"},
      {part::kGraph, "closed loops"},
      {part::kReplay, "closed loops of one drive"},
      {part::kTruth, "truth (--reference or --relations FILE)"},
      {part::kTruePath, "true trajectory (--reference FILE)"},
  }};
  std::string text;
  for (const auto& [bit, name] : kNames) {
    if ((view.needs & bit & ~parts) != 0) text += (text.empty() ? "" : std::string(joint)) + std::string(name);
  }
  return text;
}

std::string views_there_are(unsigned parts, bool is_film) {
  std::vector<std::string> names;
  for (const RenderView& view : render_views()) {
    if (!can_show(view, parts) || (is_film && !view.moves())) continue;
    if (names.empty() || names.back() != view.name) names.emplace_back(view.name);
  }
  return listed(names);
}

OutputKind read_output_kind(const std::string& path) {
  std::error_code ignored;
  if (path.ends_with('/')) return OutputKind::kFrames;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  const std::string extension = extension_of(path);
  std::vector<std::string> names;
  std::string list;
  for (const Ending& ending : kEndings) {
    if (ending.extension == extension && is_folder) {
      throw UsageError("-o: '" + path + "' is a folder; end it in / for the frames of a film");
    }
    if (ending.extension == extension) return ending.kind;
    names.emplace_back(ending.extension);
    list += (list.empty() ? "" : " ") + names.back();
  }
  if (is_folder) return OutputKind::kFrames;
  throw UsageError("-o: '" + path + "' has none of the endings " + list + ", nor does it end in / for frames" +
                   did_you_mean(extension, names));
}

std::string_view to_string(OutputKind kind) {
  constexpr std::array<std::string_view, 9> kNames{"a still in .png", "a drawing in .svg", "a page in .pdf",
                                                   "a film in .mp4",  "a film in .gif",    "frames in a folder",
                                                   "a page in .html", "a model in .glb",   "a cloud"};
  return kNames[static_cast<std::size_t>(kind)];
}

void require_writable(const RenderOptions& options, const std::string& file) {
  std::vector<std::string> inputs = options.inputs;
  inputs.insert(inputs.end(), {options.reference, options.relations, linkage_file_of(options.linkage)});
  WrittenFiles written(inputs, options.force);
  const bool are_frames = read_output_kind(file) == OutputKind::kFrames;
  const std::string first = are_frames ? frame_path(file, 0) : file;
  std::error_code ignored;
  if (!are_frames || std::filesystem::exists(first, ignored))
    written.add("--output", first);  // the folder of frames is created
}

void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output, bool is_linkage) {
  const unsigned effects = output_effects(view, output, is_linkage);
  for (const GivenOption& option : given_options(options, output)) {
    if (!option.is_given || (option.effects & effects) != 0) continue;
    const std::string made = view == nullptr ? std::string(to_string(output))
                                             : fmt::format("view {} as {}", view->words(), to_string(output));
    throw UsageError(fmt::format("{}: has no effect on {}; it is for {}", option.name, made, option.fits));
  }
}

}  // namespace gdtslam
