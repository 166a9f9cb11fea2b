#include "views.hpp"

#include <array>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "studio.hpp"

namespace gdtslam {
namespace {

using namespace effect;
using Studio = RenderStudio;

constexpr unsigned kCompared = part::kTrajectory | part::kTruth;
constexpr unsigned kScene = kSize | kDark | kLight | kPage;
constexpr unsigned kScan = kScene | kColour | kColourMap | kPoint | kLevels | kTitle | kPoints | kLinkage;
constexpr unsigned kCloud = kScan | kPath | kDistances;
constexpr unsigned kMap = kSize | kLight | kPage | kPath | kTitle;
constexpr unsigned kPlot = kSize | kLight | kTitle | kVector;
constexpr unsigned kErrorPlot = kPlot | kErrors | kSeveral;

bool can_show(const RenderView& view, unsigned parts) { return (view.needs & ~parts) == 0; }

}  // namespace

const std::vector<RenderView>& render_views() {
  static const std::vector<RenderView> views{
      {"iso", "3D cloud from the south-west and above, without the ceiling", part::kCloud, kCloud | kCamera,
       &Studio::cloud_from<CameraPreset::kIso>, 5},
      {"top", "3D cloud from straight above, without the ceiling", part::kCloud, kCloud | kCamera,
       &Studio::cloud_from<CameraPreset::kTop>},
      {"front", "3D cloud seen along y, in parallel", part::kCloud, kCloud | kCamera,
       &Studio::cloud_from<CameraPreset::kFront>},
      {"side", "3D cloud seen along x, in parallel", part::kCloud, kCloud | kCamera,
       &Studio::cloud_from<CameraPreset::kSide>},
      {"orbit", "once around the 3D cloud", part::kCloud, kCloud | kCamera, &Studio::cloud_from<CameraPreset::kIso>, 4,
       &Studio::orbit, 8.0},
      {"follow", "behind the robot along its path", part::kCloud | part::kTrajectory, kCloud, &Studio::middle_of_follow,
       0, &Studio::follow, 20.0},
      {"scan", "the robot scanning, points appearing as they are measured (--from, --to)",
       part::kCloud | part::kTrajectory | part::kMount, kScan | kStretch, &Studio::poster_of_scan, 0, &Studio::scan,
       Studio::kLongestScan_s},
      {"elevation", "elevation of the nodding scan plane over time", part::kCloud, kPlot | kStretch,
       &Studio::elevation},
      {"map", "occupancy map, with the path where there is one", part::kMap, kMap | kColourMap, &Studio::map, 3},
      {"graph", "loops over the map, how sure each pose is, and what is not to be trusted", part::kMap | part::kGraph,
       kMap & ~kPath, &Studio::graph},
      {"loops", "the path as it was driven, and how loops bend it; a still has before and after side by side",
       part::kMap | part::kReplay, kMap & ~kPath, &Studio::before_and_after_loops, 1, &Studio::loops, 12.0},
      {"field", "distance field as intensity, bright near obstacles", part::kField, kMap | kColourMap,
       &Studio::field<true>, 2},
      {"distance", "distance field in metres", part::kField, kMap | kColourMap, &Studio::field<false>},
      {"cells", "a few cells of the field with their numbers (--at, --cells)", part::kField,
       kPngSize | kLight | kPage | kTitle | kColourMap | kCells | kVector, &Studio::cells},
      {"scene", "the mount's four bars and its laser; a film is one turn", part::kLinkage, kScene | kLinkage,
       &Studio::linkage, 1, &Studio::linkage_turn, 4.0},
      {"trajectory", "the path alone, coloured by time; over the truth (--reference), several side by side",
       part::kTrajectory, kMap | kColourMap | kReference | kSeveral, &Studio::trajectory, 1},
      {"drawing", "the linkage's positions, curves and figures on one sheet", part::kLinkage,
       kPngSize | kLight | kVector | kLinkage, &Studio::linkage_sheet},
      {"errors-box", "errors of the trajectory as box plot, runs side by side", kCompared, kErrorPlot,
       &Studio::errors_box, 6},
      {"errors-cdf", "errors of the trajectory as distribution", kCompared, kErrorPlot, &Studio::errors_cdf},
      {"errors-time", "errors of the trajectory over time", kCompared, kErrorPlot, &Studio::errors_time},
      {"errors-path", "the path over the truth, coloured by its error (--reference)",
       part::kTrajectory | part::kTruePath, (kMap & ~kPath) | kColourMap | kReference | kScale | kErrors,
       &Studio::errors_path},
  };
  return views;
}

const RenderView& render_view(const std::string& name) {
  std::vector<std::string> names;
  for (const RenderView& view : render_views()) {
    if (view.name == name) return view;
    names.emplace_back(view.name);
  }
  throw UsageError("--view: there is no view '" + name + "'" + did_you_mean(name, names) +
                   " (--list-views says what this input has)");
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
  std::string text;
  for (const RenderView& view : render_views()) {
    if (!can_show(view, parts) || (is_film && !view.moves())) continue;
    text += (text.empty() ? "" : ", ") + std::string(view.name);
  }
  return text;
}

}  // namespace gdtslam
