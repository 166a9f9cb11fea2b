#include "effect.hpp"

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

/// What is made, as the options tell it apart.
struct Work {
  bool is_cloud_view = false;  ///< iso, top, ..., scan
  bool is_errors = false;
  bool is_plane = false;  ///< map or field, with a path
  bool is_cells = false;
  bool is_field = false;  ///< field, distance or cells, in a colour map
  bool is_mount = false;  ///< scene
  bool is_sheet = false;  ///< drawing or plot, light and with words
  bool is_timed = false;  ///< scan or elevation
  bool is_scan = false;
  bool is_drawing = false;
  bool is_film = false;
  bool is_page = false;
  bool is_coloured_model = false;
  bool is_plain_model = false;
};

Work work_of(const RenderView* view, OutputKind output) {
  Work work;
  work.is_film = is_film(output);
  work.is_page = output == OutputKind::kPage;
  work.is_coloured_model = output == OutputKind::kGltf;
  work.is_plain_model = output == OutputKind::kCloud;
  if (view == nullptr) return work;
  const std::string_view name = view->name;
  work.is_mount = name == "scene";
  work.is_cloud_view = view->is_scene && !work.is_mount;
  work.is_errors = name.starts_with("errors-");
  work.is_plane = name == "map" || name == "field" || name == "distance";
  work.is_cells = name == "cells";
  work.is_field = work.is_cells || name == "field" || name == "distance";
  work.is_drawing = name == "drawing";
  work.is_sheet = work.is_drawing || work.is_errors || name == "elevation";
  work.is_scan = name == "scan";
  work.is_timed = work.is_scan || name == "elevation";
  return work;
}

struct Effect {
  std::string_view option;
  bool is_given = false;
  bool has_effect = false;
  std::string_view fits;  ///< what the option is for
};

std::vector<Effect> look_effects(const RenderOptions& o, const RenderView* view, OutputKind output) {
  const Work w = work_of(view, output);
  const bool has_colours = w.is_cloud_view || w.is_coloured_model;
  const bool is_placed = w.is_cloud_view && !w.is_film && (!view->moves || view->name == "orbit");
  const bool has_size = view != nullptr && !((w.is_cells || w.is_drawing) && output != OutputKind::kPng);
  const bool is_model = w.is_coloured_model || w.is_plain_model;
  return {
      {"--size", !o.size.empty(), has_size, "pictures in pixels; cells and drawing have a size of their own"},
      {"--colour", !o.colour.empty(), has_colours, "clouds"},
      {"--colour-map", !o.colour_map.empty(), has_colours || w.is_field, "clouds and distance fields"},
      {"--range", !o.range.empty(), has_colours, "clouds"},
      {"--camera", !o.camera.empty(), is_placed, "stills of clouds"},
      {"--point-size", o.point_px > 0.0, w.is_cloud_view, "pictures of clouds"},
      {"--dark", o.is_dark, w.is_cloud_view || w.is_mount, "scenes in 3D"},
      {"--light", o.is_light, view != nullptr, "pictures"},
      {"--transparent", o.is_transparent, view != nullptr && !w.is_sheet, "scenes, maps and fields"},
      {"--no-floor", o.no_floor, w.is_cloud_view || is_model, "clouds"},
      {"--no-ceiling", o.no_ceiling, w.is_cloud_view || is_model, "clouds"},
      {"--with-ceiling", o.with_ceiling, w.is_cloud_view, "pictures of clouds"},
      {"--no-path", o.no_path, (w.is_cloud_view && !w.is_scan) || w.is_plane || w.is_coloured_model,
       "clouds, maps and fields"},
      {"--no-caption", o.no_caption, view != nullptr && !w.is_sheet, "scenes, maps and fields"},
      {"--title", !o.title.empty(), !w.is_mount && !w.is_drawing && !w.is_plain_model,
       "pictures of runs and clouds, pages and .gltf"},
  };
}

std::vector<Effect> film_effects(const RenderOptions& o, const RenderView* view, OutputKind output) {
  const Work w = work_of(view, output);
  return {
      {"--fps", o.frames_per_s > 0.0, w.is_film, "films"},
      {"--frames", o.frames > 0, w.is_film, "films"},
      {"--seconds", !o.seconds.empty(), w.is_film, "films"},
      {"--ffmpeg", !o.ffmpeg.empty(), w.is_film && output != OutputKind::kFrames, ".mp4 and .gif"},
      {"--from", !o.from.empty(), w.is_timed, "the views scan and elevation"},
      {"--to", !o.to.empty(), w.is_timed, "the views scan and elevation"},
  };
}

std::vector<Effect> data_effects(const RenderOptions& o, const RenderView* view, OutputKind output) {
  const Work w = work_of(view, output);
  const bool is_by_distance = o.colour.empty() || o.colour == "distance";
  const bool measures = (w.is_cloud_view && !w.is_scan) || w.is_coloured_model;
  const bool has_reference = has_truth(o) ? w.is_errors : w.is_page || (measures && is_by_distance);
  return {
      {"--reference", !o.reference.empty(), has_reference,
       "the views errors-* where it is a trajectory, and for clouds coloured by distance where it is a cloud"},
      {"--relations", !o.relations.empty(), w.is_errors, "the views errors-*"},
      {"--angle", o.is_angle, w.is_errors, "the views errors-*"},
      {"--at", !o.at.empty(), w.is_cells, "the view cells"},
      {"--cells", o.cells > 0, w.is_cells, "the view cells"},
      {"--squared", o.is_squared, w.is_cells, "the view cells"},
      {"--points", o.points > 0, view == nullptr || w.is_cloud_view, "clouds"},
  };
}

}  // namespace

void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output) {
  for (const auto& effects : {look_effects(options, view, output), film_effects(options, view, output),
                              data_effects(options, view, output)}) {
    for (const Effect& effect : effects) {
      if (!effect.is_given || effect.has_effect) continue;
      const std::string made = view == nullptr ? std::string(to_string(output))
                                               : fmt::format("view {} as {}", view->name, to_string(output));
      throw UsageError(fmt::format("{}: has no effect on {}; it is for {}", effect.option, made, effect.fits));
    }
  }
}

}  // namespace gdtslam
