// The views of `gdtslam render`: one table that the command, its help and --list-views read. Thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "source.hpp"

namespace gdtslam {

struct RenderView {
  std::string_view name;
  unsigned needs = 0;      ///< bits of `part`
  bool moves = false;      ///< can be a film
  bool is_scene = false;   ///< drawn with OpenGL
  bool is_vector = false;  ///< lines and words only, as plots and drawings: .svg and .pdf grow without blur
  std::string_view doc;
};
const std::vector<RenderView>& render_views();

/// Throws UsageError with the nearest name.
const RenderView& render_view(const std::string& name);
/// The view that an input is drawn as when none is named; the one that moves best for a film. Nothing where no view can
/// be a film.
const RenderView* default_view(RenderKind kind, unsigned parts, bool is_film);
/// What the view lacks of these parts, "map and 3D cloud", with these words between them; empty when nothing.
std::string missing_parts(const RenderView& view, unsigned parts, std::string_view joint = " and ");
/// Names of the views that these parts allow, "map, field, distance".
std::string views_there_are(unsigned parts, bool is_film);

}  // namespace gdtslam
