#include "views.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "options.hpp"
#include "studio.hpp"

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

/// Views of earlier versions.
constexpr std::array<std::pair<std::string_view, std::string_view>, 14> kOldViews{{
    {"iso", "--view cloud"},
    {"top", "--view cloud --from top"},
    {"front", "--view cloud --from front"},
    {"side", "--view cloud --from side"},
    {"orbit", "--view cloud, whose film goes once around"},
    {"follow", "--view cloud --from robot"},
    {"distance", "--view field --as distance"},
    {"drawing", "gdtslam linkage LINKAGE --picture FILE"},
    {"elevation", "--view scan, which shows the elevation beside the robot"},
    {"cells", "--view field"},
    {"errors-box", "--view errors"},
    {"errors-cdf", "--view errors --as cdf"},
    {"errors-time", "--view errors --as time"},
    {"errors-path", "--view errors --as path"},
}};

bool can_show(const RenderView& view, unsigned parts) { return (view.needs & ~parts) == 0; }

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
  for (const auto& [old, now] : kOldViews) {
    if (old == name) throw UsageError("--view " + name + " has a new spelling: " + std::string(now));
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

}  // namespace gdtslam
