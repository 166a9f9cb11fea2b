#include "views.hpp"

#include <array>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kErrors = part::kTrajectory | part::kTruth;

const RenderView* named(std::string_view name) {
  for (const RenderView& view : render_views()) {
    if (view.name == name) return &view;
  }
  return nullptr;
}

bool can_show(const RenderView& view, unsigned parts) { return (view.needs & ~parts) == 0; }

}  // namespace

const std::vector<RenderView>& render_views() {
  constexpr bool kMoves = true;
  constexpr bool kStill = false;
  constexpr bool kScene = true;
  constexpr bool kFlat = false;
  constexpr bool kVector = true;
  constexpr bool kPixels = false;
  static const std::vector<RenderView> views{
      {"iso", part::kCloud, kStill, kScene, kPixels, "3D cloud from the south-west and above, without the ceiling"},
      {"top", part::kCloud, kStill, kScene, kPixels, "3D cloud from straight above, without the ceiling"},
      {"front", part::kCloud, kStill, kScene, kPixels, "3D cloud seen along y, in parallel"},
      {"side", part::kCloud, kStill, kScene, kPixels, "3D cloud seen along x, in parallel"},
      {"orbit", part::kCloud, kMoves, kScene, kPixels, "once around the 3D cloud"},
      {"follow", part::kCloud | part::kTrajectory, kMoves, kScene, kPixels, "behind the robot along its path"},
      {"scan", part::kCloud | part::kTrajectory | part::kMount, kMoves, kScene, kPixels,
       "the robot scanning, points appearing as they are measured (--from, --to)"},
      {"elevation", part::kCloud, kStill, kFlat, kVector, "elevation of the nodding scan plane over time"},
      {"map", part::kMap, kStill, kFlat, kPixels, "occupancy map, with the path where there is one"},
      {"field", part::kField, kStill, kFlat, kPixels, "distance field as intensity, bright near obstacles"},
      {"distance", part::kField, kStill, kFlat, kPixels, "distance field in metres"},
      {"cells", part::kField, kStill, kFlat, kVector, "a few cells of the field with their numbers (--at, --cells)"},
      {"scene", part::kLinkage, kMoves, kScene, kPixels, "the mount's four bars and its laser; a film is one turn"},
      {"drawing", part::kLinkage, kStill, kFlat, kVector, "the linkage's positions, curves and figures on one sheet"},
      {"errors-box", kErrors, kStill, kFlat, kVector, "errors of the trajectory as box plot, runs side by side"},
      {"errors-cdf", kErrors, kStill, kFlat, kVector, "errors of the trajectory as distribution"},
      {"errors-time", kErrors, kStill, kFlat, kVector, "errors of the trajectory over time"},
  };
  return views;
}

const RenderView& render_view(const std::string& name) {
  if (const RenderView* const view = named(name)) return *view;
  std::vector<std::string> names;
  for (const RenderView& view : render_views()) names.emplace_back(view.name);
  throw UsageError("--view: there is no view '" + name + "'" + did_you_mean(name, names) +
                   " (--list-views says what this input has)");
}

const RenderView* default_view(RenderKind kind, unsigned parts, bool is_film) {
  const bool is_linkage = kind == RenderKind::kLinkage;
  if (!is_film && can_show(*named("errors-box"), parts)) return named("errors-box");
  const auto order =
      is_film ? std::vector<std::string_view>{is_linkage ? "scene" : "orbit", "scene"}
              : std::vector<std::string_view>{is_linkage ? "scene" : "iso", "map", "field", "scene", "errors-box"};
  for (const std::string_view name : order) {
    if (const RenderView* const view = named(name); can_show(*view, parts)) return view;
  }
  return nullptr;
}

std::string missing_parts(const RenderView& view, unsigned parts, std::string_view joint) {
  constexpr std::array<std::pair<unsigned, std::string_view>, 7> kNames{{
      {part::kMap, "map"},
      {part::kField, "distance field"},
      {part::kTrajectory, "trajectory"},
      {part::kCloud, "3D cloud"},
      {part::kLinkage, "linkage (--linkage NAME|FILE)"},
      {part::kMount, "linkage (--linkage NAME|FILE)"},
      {part::kTruth, "truth (--reference or --relations FILE)"},
  }};
  std::string text;
  for (const auto& [bit, name] : kNames) {
    if ((view.needs & bit & ~parts) != 0) text += (text.empty() ? "" : std::string(joint)) + std::string(name);
  }
  return text;
}

std::string views_there_are(unsigned parts, bool is_film) {
  std::string text;
  for (const RenderView& view : render_views()) {
    if (!can_show(view, parts) || (is_film && !view.moves)) continue;
    text += (text.empty() ? "" : ", ") + std::string(view.name);
  }
  return text;
}

}  // namespace gdtslam
