#include "run_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_review.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

constexpr std::uint32_t kMostViewSide_px = 16384;

PathOverlay path_overlay(const RunReader& run) {
  if (!run.has_trajectory()) return {};
  const RunSummary& summary = run.summary();
  return {run.trajectory(), summary.keyframes, summary.doubtful, summary.drives};
}

MapLook make_look(const RunReader& run, const RunViewRequest& request, const Trajectory& path) {
  MapLook look;
  look.title = request.title.value_or(run.name());
  const RunSummary& summary = run.summary();
  look.subtitle =
      run_subtitle({summary.scans, summary.keyframes.size(), summary.doubtful.size()}, path, summary.drives);
  look.colour_map = request.colour_map;
  return look;
}

PictureSize size_of_view(const RunViewRequest& request, const GridGeometry& content) {
  return request.size.value_or(size_for_content(content.width, content.height));
}

Canvas map_of_run(const RunReader& run, const RunViewRequest& request) {
  const PathOverlay overlay = path_overlay(run);
  return map_view(run.map(), overlay, make_look(run, request, overlay.trajectory), request.size);
}

Canvas graph_view(const RunReader& run, const RunViewRequest& request) {
  const std::optional<LoopFindings> found = run.doubts().loops;
  if (!found) throw InputError({run.folder(), 0}, "closed no loops, so there is no graph to draw");
  const OccupancyMap map = run.map();
  const Trajectory trajectory = run.trajectory();
  const RunSummary& summary = run.summary();
  const std::vector<PoseCovariance> covariances = run.covariances().value_or(std::vector<PoseCovariance>());
  MapLook look = make_look(run, request, trajectory);
  look.subtitle = graph_subtitle(found->loops, found->uncertain, summary.scans);
  return graph_picture(
      map, graph_overlay(trajectory, summary.keyframes, found->loops, covariances, found->uncertain, summary.drives),
      look, size_of_view(request, map.geometry));
}

Canvas field_view(const RunReader& run, const RunViewRequest& request, bool is_intensity) {
  DistanceFieldFile file = run.field();
  const FieldPicture field{file.geometry, std::move(file.cells), file.cap};
  const PathOverlay overlay = path_overlay(run);
  MapLook look = make_look(run, request, overlay.trajectory);
  look.is_intensity = is_intensity;
  return field_picture(field, overlay, look, size_of_view(request, field.geometry));
}

Canvas intensity_view(const RunReader& run, const RunViewRequest& request) { return field_view(run, request, true); }
Canvas distance_view(const RunReader& run, const RunViewRequest& request) { return field_view(run, request, false); }

using DrawView = Canvas (*)(const RunReader&, const RunViewRequest&);
constexpr std::array<std::pair<std::string_view, DrawView>, 4> kRunViews{
    {{"map", map_of_run}, {"graph", graph_view}, {"field", intensity_view}, {"distance", distance_view}}};

}  // namespace

Canvas run_view(const RunReader& run, const RunViewRequest& request) {
  if (request.size && (std::min(request.size->width, request.size->height) < 1 ||
                       std::max(request.size->width, request.size->height) > kMostViewSide_px)) {
    throw UsageError(fmt::format("a picture of {}x{}: each side has 1 to {} pixels", request.size->width,
                                 request.size->height, kMostViewSide_px));
  }
  std::vector<std::string> names;
  for (const auto& [name, draw] : kRunViews) {
    if (name == request.view) return draw(run, request);
    names.emplace_back(name);
  }
  throw UsageError(fmt::format("there is no view '{}'{} ({})", request.view, did_you_mean(request.view, names),
                               fmt::join(names, ", ")));
}

std::string picture_bytes(const Canvas& drawing, const std::string& format) {
  if (format == "svg") return draw_svg(drawing);
  if (format == "pdf") return draw_pdf(drawing);
  if (format != "png") {
    throw UsageError(fmt::format("there is no format '{}' of pictures (png, svg, pdf)", format));
  }
  const RgbaImage image = rasterise(drawing);
  return encode_png(image.width, image.height, image.pixels);
}

}  // namespace gdtslam
