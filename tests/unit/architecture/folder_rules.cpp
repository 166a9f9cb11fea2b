#include "folder_rules.hpp"

#include <algorithm>
#include <regex>
#include <sstream>

#include "tree.hpp"

namespace gdtslam::architecture {
namespace {

// A command stands on the rooms that several commands share, never on another command.
const std::set<std::string, std::less<>> kShared{"tools/gdtslam/shell", "tools/gdtslam/shell/device",
                                                 "tools/gdtslam/shell/help", "tools/gdtslam/drawings"};

std::set<std::string, std::less<>> shared_and(std::initializer_list<std::string> rooms) {
  std::set<std::string, std::less<>> all = kShared;
  all.insert(rooms.begin(), rooms.end());
  return all;
}

Arrows make_arrows() {
  Arrows arrows{
      {"calib", {"calib/linkage"}},
      {"calib/linkage", {}},
      {"calib/calibration", {"calib", "calib/linkage"}},
      {"engine/compute", {"engine/compute/kernels"}},
      {"engine/compute/kernels", {}},
      {"engine/drawing", {}},
      {"engine/drawing/maps", {"engine/drawing"}},
      {"engine/drawing/page", {"engine/drawing"}},
      {"engine/drawing/plots", {"engine/drawing", "engine/drawing/maps"}},
      {"engine/drawing/raster", {"engine/drawing"}},
      {"engine/io", {}},
      {"engine/io/yaml", {"engine/io"}},
      {"engine/io/recordings/containers", {"engine/io", "engine/io/yaml"}},
      {"engine/io/recordings", {"engine/io", "engine/io/recordings/containers"}},
      {"engine/io/tables", {"engine/io"}},
      {"engine/io/logs", {"engine/io", "engine/io/recordings", "engine/io/tables"}},
      {"engine/io/writers", {"engine/io", "engine/io/logs", "engine/io/tables"}},
      {"engine/io/clouds", {"engine/io", "engine/io/logs"}},
      {"engine/io/meshes", {"engine/io", "engine/io/logs", "engine/io/clouds"}},
      {"engine/io/maps", {"engine/io", "engine/io/logs", "engine/io/yaml"}},
      {"engine/mapping",
       {"engine/mapping/back_end", "engine/mapping/match", "engine/mapping/cost", "engine/mapping/surface",
        "engine/mapping/map"}},
      {"engine/mapping/back_end",
       {"engine/mapping/adjust", "engine/mapping/loops", "engine/mapping/wheels", "engine/mapping/surface",
        "engine/mapping/graph"}},
      {"engine/mapping/changes", {"engine/mapping/map"}},
      {"engine/mapping/tracking",
       {"engine/mapping/match", "engine/mapping/cost", "engine/mapping/wheels", "engine/mapping/graph",
        "engine/mapping/map", "engine/mapping/map/store"}},
      {"engine/mapping/adjust", {"engine/mapping/surface", "engine/mapping/graph"}},
      {"engine/mapping/loops",
       {"engine/mapping/wheels", "engine/mapping/surface", "engine/mapping/graph", "engine/mapping/map"}},
      {"engine/mapping/sites",
       {"engine/mapping/adjust", "engine/mapping/graph", "engine/mapping/loops", "engine/mapping/surface"}},
      {"engine/mapping/wheels", {"engine/mapping/surface", "engine/mapping/graph"}},
      {"engine/mapping/surface", {"engine/mapping/graph"}},
      {"engine/mapping/graph", {}},
      {"engine/mapping/nodding",
       {"engine/mapping/match", "engine/mapping/cost", "engine/mapping/graph", "engine/mapping/map"}},
      {"engine/mapping/strokes", {"engine/mapping/graph"}},
      {"engine/mapping/match",
       {"engine/mapping/certified", "engine/mapping/cost", "engine/mapping/graph", "engine/mapping/map",
        "engine/mapping/wheels"}},
      {"engine/mapping/certified", {"engine/mapping/cost", "engine/mapping/map"}},
      {"engine/mapping/cost", {"engine/mapping/map"}},
      {"engine/mapping/map", {"engine/mapping/map/store"}},
      {"engine/mapping/map/store", {}},
      {"engine/runs",
       {"engine/runs/continuing", "engine/runs/drive", "engine/runs/folder", "engine/runs/keyframes",
        "engine/runs/streams"}},
      {"engine/runs/continuing", {"engine/runs/folder"}},
      {"engine/runs/transaction", {}},
      {"engine/runs/folder",
       {"engine/runs/drive", "engine/runs/keyframes", "engine/runs/streams", "engine/runs/tiles",
        "engine/runs/transaction"}},
      {"engine/runs/tiles", {"engine/runs/keyframes", "engine/runs/drive"}},
      {"engine/runs/keyframes", {}},
      {"engine/runs/drive", {"engine/runs/motion", "engine/runs/streams"}},
      {"engine/runs/localizer", {"engine/runs/folder", "engine/runs/streams"}},
      {"engine/runs/registration", {"engine/runs/keyframes"}},
      {"engine/runs/evaluation", {"engine/runs/streams"}},
      {"engine/runs/sites", {"engine/runs/drive", "engine/runs/folder", "engine/runs/keyframes", "engine/runs/tiles"}},
      {"engine/runs/fleet", {"engine/runs", "engine/runs/folder", "engine/runs/transaction"}},
      {"engine/runs/edits",
       {"engine/runs/continuing", "engine/runs/drive", "engine/runs/folder", "engine/runs/keyframes",
        "engine/runs/motion", "engine/runs/streams", "engine/runs/tiles"}},
      {"engine/runs/streams", {"engine/runs/motion"}},
      {"engine/runs/motion", {}},
      {"engine/vulkan",
       {"engine/vulkan/commands", "engine/vulkan/device", "engine/vulkan/dispatch", "engine/vulkan/memory"}},
      {"engine/vulkan/dispatch", {"engine/vulkan/commands", "engine/vulkan/device", "engine/vulkan/memory"}},
      {"engine/vulkan/memory", {"engine/vulkan/commands", "engine/vulkan/device"}},
      {"engine/vulkan/commands", {"engine/vulkan/device"}},
      {"engine/vulkan/device", {}},
      {"engine/vulkan/missing", {}},
      {"viewer/scene/scan", {"viewer/graphics", "viewer/scene", "viewer/scene/cloud", "viewer/scene/linkage"}},
      {"viewer/scene/cloud", {"viewer/graphics", "viewer/scene", "viewer/scene/linkage"}},
      {"viewer/scene/linkage", {"viewer/graphics", "viewer/scene"}},
      {"viewer/scene", {}},
      {"viewer/graphics", {"viewer/scene"}},
      {"tools/gdtslam", {"tools/gdtslam/shell"}},
      {"tools/gdtslam/shell", {"tools/gdtslam/shell/help"}},
      {"tools/gdtslam/shell/help", {}},
      {"tools/gdtslam/shell/device", {"tools/gdtslam/shell", "tools/gdtslam/shell/help"}},
      {"tools/gdtslam/drawings", {"tools/gdtslam/shell"}},
      {"tools/gdtslam/scenes", {"tools/gdtslam/shell"}},
      {"tools/gdtslam/render", shared_and({"tools/gdtslam/render/files"})},
      {"tools/gdtslam/render/files", {"tools/gdtslam/shell"}},
      {"tools/gdtslam/map", shared_and({"tools/gdtslam/render"})},
      {"tools/gdtslam/live", shared_and({"tools/gdtslam/live/input", "tools/gdtslam/live/output",
                                         "tools/gdtslam/live/page", "tools/gdtslam/live/snapshot"})},
      {"tools/gdtslam/live/input", {"tools/gdtslam/live/network", "tools/gdtslam/shell"}},
      {"tools/gdtslam/live/network", {}},
      {"tools/gdtslam/live/output", {}},
      {"tools/gdtslam/live/page", {}},
      {"tools/gdtslam/live/page/missing", {"tools/gdtslam/live/page"}},
      {"tools/gdtslam/live/page/server", {"tools/gdtslam/live/network", "tools/gdtslam/live/page"}},
      {"tools/gdtslam/live/snapshot", {"tools/gdtslam/shell"}},
      {"tools/gdtslam/simulate", shared_and({"tools/gdtslam/scenes"})},
      {"tools/gdtslam/evaluate", shared_and({"tools/gdtslam/scenes"})},
      {"tools/lab", {"tools/gdtslam/shell"}},
      {"tools/lab/matchers", kShared},
      {"tools/lab/compare", shared_and({"tools/lab/matchers"})},
      {"tools/lab/ablation", kShared},
      {"tools/lab/bench", kShared},
  };
  // A command that is not in the table knows the shared rooms.
  constexpr std::string_view kCommand = "/command.cpp";
  for (const SourceFile& file : code()) {
    if (!file.path.starts_with("tools/gdtslam/") || !file.path.ends_with(kCommand)) continue;
    arrows.emplace(file.path.substr(0, file.path.size() - kCommand.size()), kShared);
  }
  return arrows;
}

bool goes_round(const Arrows& arrows, const std::string& room, std::vector<std::string>& way,
                std::set<std::string>& done) {
  if (std::find(way.begin(), way.end(), room) != way.end()) {
    way.push_back(room);
    return true;
  }
  if (done.contains(room)) return false;
  way.push_back(room);
  if (const auto found = arrows.find(room); found != arrows.end()) {
    for (const std::string& below : found->second) {
      if (goes_round(arrows, below, way, done)) return true;
    }
  }
  way.pop_back();
  done.insert(room);
  return false;
}

}  // namespace

const Arrows& room_arrows() {
  static const Arrows arrows = make_arrows();
  return arrows;
}

std::string room_of(std::string_view path) {
  const std::size_t end = path.rfind('/');
  std::string room(path.substr(0, end == std::string_view::npos ? 0 : end));
  if (const std::size_t at = room.find("/include/gdtslam/"); at != std::string::npos) room.resize(at);
  // Each kernel has a folder of its own; with the table of their functions, how they are called, the units that
  // compile all of them once per instruction set and the cases that each is tried on they are one room.
  constexpr std::string_view kKernels = "engine/compute/kernels";
  if (room.starts_with(kKernels) || room == "engine/compute/isa" || room == "engine/compute/cpu" ||
      room == "engine/compute/cases") {
    room = kKernels;
  }
  return room;
}

std::vector<Violation> room_violations(std::string_view path, std::string_view text) {
  static const std::regex directive(R"re(^\s*#\s*include\s*"((engine|calib|viewer|tools)/[^"]+)")re");
  const std::string room = room_of(path);
  const std::string part = part_of(path);
  std::vector<Violation> found;
  if (part.empty() || part == "tests" || part == "examples") return found;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    std::smatch match;
    if (!std::regex_search(line, match, directive)) continue;
    const std::string header = match.str(1);
    const std::string other = room_of(header);
    if (part_of(header) != part || other == room) continue;
    const auto row = room_arrows().find(room);
    if (row == room_arrows().end() || !row->second.contains(other)) {
      found.push_back({number, "includes " + header + ": " + room + " must not know the room " + other});
    }
  }
  return found;
}

std::vector<std::string> circle_in(const Arrows& arrows) {
  std::set<std::string> done;
  for (const auto& [room, below] : arrows) {
    std::vector<std::string> way;
    if (goes_round(arrows, room, way, done)) return way;
  }
  return {};
}

}  // namespace gdtslam::architecture
