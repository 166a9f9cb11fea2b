#include "output.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <system_error>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "files/film_writer.hpp"
#include "gdtslam/core/error.hpp"
#include "source.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

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

using namespace effect;

/// Effects that options have on a view in this form; for a file without a view the form alone decides.
unsigned effects_of(const RenderView* view, OutputKind output, bool is_linkage) {
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
  unsigned effects = 0;   ///< one of them is enough
  std::string_view fits;  ///< what the option is for
};

std::vector<GivenOption> given_options(const RenderOptions& o, OutputKind output) {
  const bool colours_by_distance = o.colour.empty() || o.colour == "distance" || output == OutputKind::kPage;
  const unsigned reference = has_true_path(o) ? kReference : colours_by_distance ? kDistances : 0U;
  const Background background = background_of(o.background);
  const Hidden hidden = hidden_of(o.hide);
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

OutputKind output_kind_of(const std::string& path) {
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
  const bool are_frames = output_kind_of(file) == OutputKind::kFrames;
  const std::string first = are_frames ? frame_path(file, 0) : file;
  std::error_code ignored;
  if (!are_frames || std::filesystem::exists(first, ignored))
    written.add("--output", first);  // the folder of frames is made
}

void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output, bool is_linkage) {
  const unsigned effects = effects_of(view, output, is_linkage);
  for (const GivenOption& option : given_options(options, output)) {
    if (!option.is_given || (option.effects & effects) != 0) continue;
    const std::string made = view == nullptr ? std::string(to_string(output))
                                             : fmt::format("view {} as {}", view->words(), to_string(output));
    throw UsageError(fmt::format("{}: has no effect on {}; it is for {}", option.name, made, option.fits));
  }
}

}  // namespace gdtslam
