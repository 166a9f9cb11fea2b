#include "run_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "engine/core/worker_pool.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {
namespace {

// The map with the path: the view `map` of the run.
Canvas draw_overview(const MapRequest& request, const MapOutcome& outcome) {
  PathOverlay overlay{outcome.trajectory, outcome.keyframes, {}, outcome.drives};
  for (const DoubtfulScan& scan : outcome.doubtful) overlay.doubtful.push_back(scan.index);
  MapLook look;
  look.title = run_title(request.logs);
  look.subtitle = run_subtitle({scans_of(outcome), outcome.keyframes.size(), outcome.doubtful.size()},
                               outcome.trajectory, outcome.drives);
  return map_view(outcome.occupancy, overlay, look);
}

// The loops of the path, and its unreliable stretches.
Canvas draw_graph(const MapRequest& request, const MapOutcome& outcome) {
  const ClosedPath& closed = *outcome.closed;
  const std::vector<UncertainStretch> uncertain = uncertain_stretches(closed.covariances);
  const GridGeometry& geometry = outcome.occupancy.geometry;
  MapLook look;
  look.title = run_title(request.logs);
  look.subtitle = graph_subtitle(closed.loops, uncertain, scans_of(outcome));
  return graph_picture(
      outcome.occupancy,
      graph_overlay(outcome.trajectory, outcome.keyframes, closed.loops, closed.covariances, uncertain, outcome.drives),
      look, size_for_content(geometry.width, geometry.height));
}

const std::string kNoPicture = "no picture ";

/// The bytes of a PNG file, or the reason for their absence.
struct EncodedPicture {
  std::optional<std::string> png;
  std::vector<LogReader::Warning> warnings;
};

EncodedPicture encoded_picture(const std::string& name, const std::function<Canvas()>& draw) {
  EncodedPicture file;
  try {
    const RgbaImage image = rasterise(draw());
    file.png = encode_png(image.width, image.height, image.pixels);
  } catch (const std::exception& error) {
    file.warnings.push_back({kNoPicture + name, 1, error.what()});
  }
  return file;
}

void write_encoded(RunFolder& folder, const std::string& name, const EncodedPicture& picture,
                   std::vector<LogReader::Warning>& warnings) {
  if (picture.png) write_file_atomically(folder.staged(name + ".png"), *picture.png);
  warnings.insert(warnings.end(), picture.warnings.begin(), picture.warnings.end());
}

}  // namespace

std::string run_title(const std::vector<std::string>& logs) {
  constexpr std::size_t kMostLetters = 80;
  if (logs.front() == "-") return "stdin";
  return one_line(std::filesystem::path(sidecar_path(logs.front(), "")).filename().string(), kMostLetters);
}

std::string run_subtitle(const RunCounts& counts, const Trajectory& trajectory, std::span<const std::size_t> drives) {
  std::string text = counted(counts.scans, "scan");
  if (counts.keyframes > 0) text += ", " + counted(counts.keyframes, "keyframe");
  if (counts.doubtful > 0) text += ", " + with_commas(counts.doubtful) + " doubtful";
  if (const std::string length = path_length_text(trajectory, drives); !length.empty())
    text += ", " + length + " of path";
  return text;
}

std::string path_length_text(const Trajectory& trajectory, std::span<const std::size_t> drives) {
  constexpr double kStands_m = 0.05;
  const double length_m = path_length_m(trajectory, drives);
  return length_m < kStands_m ? std::string() : fmt::format("{:.1f} m", length_m);
}

Canvas map_view(const OccupancyMap& map, const PathOverlay& overlay, const MapLook& look,
                const std::optional<PictureSize>& size) {
  return map_picture(map, overlay, look, size.value_or(size_for_content(map.geometry.width, map.geometry.height)));
}

GraphOverlay graph_overlay(const Trajectory& trajectory, const std::vector<std::size_t>& keyframes,
                           std::span<const ClosedLoop> loops, const std::vector<PoseCovariance>& covariances,
                           std::span<const UncertainStretch> uncertain, const std::vector<std::size_t>& drives) {
  GraphOverlay overlay{.trajectory = trajectory,
                       .keyframes = keyframes,
                       .loops = {},
                       .covariances = covariances,
                       .doubtful = {},
                       .numbers = {},
                       .drives = drives};
  overlay.loops.reserve(loops.size());
  for (const ClosedLoop& loop : loops) overlay.loops.push_back({loop.from, loop.to, loop.weight, loop.is_on});
  overlay.doubtful.reserve(uncertain.size());
  for (const UncertainStretch& stretch : uncertain) overlay.doubtful.push_back({stretch.from, stretch.to});
  return overlay;
}

std::string loops_text(std::size_t found, std::size_t on) {
  if (found == 0) return "no loop found";
  const std::string loops = counted(found, "loop");
  if (on == found) return loops + (found == 1 ? " on" : ", all on");
  return on == 0 ? loops + " switched off" : fmt::format("{} of {} on", with_commas(on), loops);
}

std::string graph_subtitle(std::span<const ClosedLoop> loops, std::span<const UncertainStretch> uncertain,
                           std::uint64_t scans) {
  const auto on = std::count_if(loops.begin(), loops.end(), [](const ClosedLoop& loop) { return loop.is_on; });
  std::size_t doubted = 0;
  double sigma_m = 0.0;
  for (const UncertainStretch& stretch : uncertain) {
    doubted += stretch.to - stretch.from + 1;
    sigma_m = std::max(sigma_m, stretch.sigma_m);
  }
  std::string text = counted(scans, "scan");
  text += ", " + loops_text(loops.size(), static_cast<std::size_t>(on));
  if (doubted > 0) {
    text += fmt::format("; {} not to be trusted, standard deviation up to {:.2g} m", counted(doubted, "scan"), sigma_m);
  }
  return text;
}

bool is_picture_warning(const std::string& kind) { return kind.starts_with(kNoPicture); }

void write_picture(RunFolder& folder, const std::string& name, const Canvas& picture,
                   std::vector<LogReader::Warning>& warnings) {
  write_encoded(folder, name, encoded_picture(name, [&] { return picture; }), warnings);
}

void write_run_pictures(RunFolder& folder, const MapRequest& request, MapOutcome& outcome) {
  const auto tell = [&request](const char* what) {
    if (request.finishing) request.finishing(what);
  };
  const bool has_overview = request.with_pictures && request.with_map;
  const bool has_graph = has_overview && outcome.closed;
  if (has_overview) tell("overview.png");
  if (has_graph) tell("graph.png");
  EncodedPicture overview;
  EncodedPicture graph;
  const unsigned most = has_graph ? 2 : 1;
  WorkerPool workers(std::min(threads_meant(request.on_failure.cpu.threads), most));
  workers.run(has_overview ? most : 0, 1, [&](std::uint64_t begin, std::uint64_t end) {
    if (begin == 0) overview = encoded_picture("overview", [&] { return draw_overview(request, outcome); });
    if (end == 2) graph = encoded_picture("graph", [&] { return draw_graph(request, outcome); });
  });
  if (has_overview) write_encoded(folder, "overview", overview, outcome.warnings);
  if (has_graph) write_encoded(folder, "graph", graph, outcome.warnings);
}

}  // namespace gdtslam
