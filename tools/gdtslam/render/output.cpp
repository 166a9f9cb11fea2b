#include "output.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <system_error>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "film_writer.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/pictures/source.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

struct Ending {
  std::string_view extension;
  OutputKind kind;
};
constexpr std::array<Ending, 13> kEndings{{{".png", OutputKind::kPng},
                                           {".jpg", OutputKind::kJpeg},
                                           {".jpeg", OutputKind::kJpeg},
                                           {".svg", OutputKind::kSvg},
                                           {".pdf", OutputKind::kPdf},
                                           {".mp4", OutputKind::kMp4},
                                           {".gif", OutputKind::kGif},
                                           {".html", OutputKind::kPage},
                                           {".htm", OutputKind::kPage},
                                           {".gltf", OutputKind::kGltf},
                                           {".glb", OutputKind::kGlb},
                                           {".ply", OutputKind::kCloud},
                                           {".pcd", OutputKind::kCloud}}};

using namespace effect;

/// What options change of a view in this form; of what no view belongs to, by its form alone.
unsigned effects_of(const RenderView* view, OutputKind output, bool is_linkage) {
  if (is_linkage) return kTitle | kLinkage;
  if (output == OutputKind::kPage) return kTitle | kDistances | kPoints | kLinkage;
  if (output == OutputKind::kCloud) return kLevels | kPoints;
  if (is_gltf(output)) return kColour | kColourMap | kLevels | kPath | kTitle | kDistances | kPoints;
  unsigned effects = view->effects;
  if ((effects & kPngSize) != 0 && is_pixels(output)) effects |= kSize;
  if (!is_film(output)) return effects;
  return (effects & ~kCamera) | kFilm | (output == OutputKind::kFrames ? 0U : kFfmpeg);
}

struct GivenOption {
  std::string_view name;
  bool is_given = false;
  unsigned effects = 0;   ///< one of them is enough
  std::string_view fits;  ///< what the option is for
};

std::vector<GivenOption> options_of(const RenderOptions& o, OutputKind output) {
  const bool colours_by_distance = o.colour.empty() || o.colour == "distance" || output == OutputKind::kPage;
  // A log has used it when it was mapped.
  const bool draws_linkage = !o.linkage.empty() && kind_of_input(o.inputs.front()) != RenderKind::kLog;
  const unsigned of_reference = has_true_path(o) ? kErrors | kReference : colours_by_distance ? kDistances : 0U;
  return {
      {"--size", !o.size.empty(), kSize, "pictures in pixels; cells and drawing have a size of their own"},
      {"--colour", !o.colour.empty(), kColour, "clouds"},
      {"--colour-map", !o.colour_map.empty(), kColourMap, "clouds, distance fields and paths"},
      {"--range", !o.range.empty(), kColour | kScale, "clouds and the view errors-path"},
      {"--camera", !o.camera.empty(), kCamera, "stills of clouds"},
      {"--point-size", o.point_px > 0.0, kPoint, "pictures of clouds"},
      {"--dark", o.is_dark, kDark, "scenes in 3D"},
      {"--light", o.is_light, kLight, "pictures"},
      {"--transparent", o.is_transparent, kPage, "scenes, maps and fields"},
      {"--no-floor", o.no_floor, kLevels, "clouds"},
      {"--no-ceiling", o.no_ceiling, kLevels, "clouds"},
      {"--with-ceiling", o.with_ceiling, kPoint, "pictures of clouds"},
      {"--no-path", o.no_path, kPath, "clouds, maps and fields"},
      {"--no-caption", o.no_caption, kPage, "scenes, maps and fields"},
      {"--title", !o.title.empty(), kTitle, "pictures of runs and clouds, pages, .gltf and .glb"},
      {"--fps", o.frames_per_s > 0.0, kFilm, "films"},
      {"--frames", o.frames > 0, kFilm, "films"},
      {"--seconds", !o.seconds.empty(), kFilm, "films"},
      {"--ffmpeg", !o.ffmpeg.empty(), kFfmpeg, ".mp4 and .gif"},
      {"--from", !o.from.empty(), kStretch, "the views scan and elevation"},
      {"--to", !o.to.empty(), kStretch, "the views scan and elevation"},
      {"--reference", !o.reference.empty(), of_reference,
       "the views trajectory and errors-* where it is a trajectory, and for clouds coloured by distance where it is a "
       "cloud"},
      {"--relations", !o.relations.empty(), kErrors, "the views errors-*"},
      {"--angle", o.is_angle, kErrors, "the views errors-*"},
      {"--at", !o.at.empty(), kCells, "the view cells"},
      {"--cells", o.cells > 0, kCells, "the view cells"},
      {"--squared", o.is_squared, kCells, "the view cells"},
      {"--points", o.points > 0, kPoints, "clouds"},
      {"--linkage", draws_linkage, kLinkage,
       "logs, pictures of clouds, the views scene and drawing, pages, and .gltf and .glb of a linkage"},
  };
}

}  // namespace

OutputKind output_kind_of(const std::string& path) {
  std::error_code ignored;
  if (path.ends_with('/')) return OutputKind::kFrames;
  const bool is_folder = fs::is_directory(path, ignored);
  if (!is_folder && is_frame_pattern(path)) {
    frame_path(path, 0);  // refuses what is no pattern
    return OutputKind::kFrames;
  }
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
  constexpr std::array<std::string_view, 11> kNames{"a still in .png",    "a still in .jpg", "a drawing in .svg",
                                                    "a page in .pdf",     "a film in .mp4",  "a film in .gif",
                                                    "frames in a folder", "a page in .html", "a model in .gltf",
                                                    "a model in .glb",    "a cloud"};
  return kNames[static_cast<std::size_t>(kind)];
}

void require_writable(const RenderOptions& options, const std::string& file) {
  std::vector<std::string> inputs = options.inputs;
  inputs.insert(inputs.end(), {options.reference, options.relations, linkage_file_of(options.linkage)});
  for (const std::string& input : options.inputs) inputs.push_back(linkage_sidecar(input));
  WrittenFiles written(inputs, options.force);
  if (!options.run_folder.empty()) written.add_run(options.run_folder);
  const bool are_frames = output_kind_of(file) == OutputKind::kFrames;
  const std::string first = are_frames ? frame_path(file, 0) : file;
  std::error_code ignored;
  if (!are_frames || fs::exists(first, ignored)) written.add("--output", first);  // the folder of frames is made
}

void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output, bool is_linkage) {
  const unsigned effects = effects_of(view, output, is_linkage);
  for (const GivenOption& option : options_of(options, output)) {
    if (!option.is_given || (option.effects & effects) != 0) continue;
    const std::string made =
        view == nullptr ? std::string(to_string(output)) : fmt::format("view {} as {}", view->name, to_string(output));
    throw UsageError(fmt::format("{}: has no effect on {}; it is for {}", option.name, made, option.fits));
  }
}

}  // namespace gdtslam
