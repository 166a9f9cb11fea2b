#include "draw.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/pictures/studio.hpp"

namespace gdtslam::reproduce {

std::string_view to_string(Verdict verdict) {
  constexpr std::array<std::string_view, 3> kNames{"within", "outside", "no verdict"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::string_view to_string(Origin origin) {
  constexpr std::array<std::string_view, 3> kNames{"computed", "simulated", "simulated and real"};
  return kNames[static_cast<std::size_t>(origin)];
}

void go_on(const PartContext& place) {
  if (place.stop()) throw Error(ExitCode::kInterrupted, "interrupted");
}

void add_picture(Part& part, const PartContext& place, const Canvas& drawing, Picture picture, double scale) {
  go_on(place);
  write_file_atomically(place.folder + "/" + picture.file, drawing_bytes(drawing, picture.file, scale));
  part.pictures.push_back(std::move(picture));
}

Canvas titled_sheet(double width, double height, const std::string& title, const std::string& words) {
  Canvas canvas(width, height, title);
  canvas.rectangle({0.0, 0.0}, width, height, Fill{kLightTheme.page});
  canvas.text({24.0, 38.0}, title, {.size = 20.0, .is_bold = true});
  canvas.text({24.0, 60.0}, words, {.size = 13.0, .colour = ink::kQuiet});
  return canvas;
}

void add_view(Part& part, const PartContext& place, const ViewOrder& order, Picture picture) {
  go_on(place);
  RenderOptions options = order.options;
  options.inputs = order.inputs;
  options.view = order.view;
  options.size = order.size;
  options.quiet = true;
  std::vector<RenderSource> sources;
  sources.reserve(order.inputs.size());
  for (const std::string& input : order.inputs) sources.emplace_back(input);
  RenderStudio studio(options, sources);
  std::optional<PictureSize> size;
  if (!order.size.empty()) size = size_of(order.size);
  add_picture(part, place, studio.still(render_view(order.view), size), std::move(picture));
}

std::string length_with_unit(double length_m) {
  const double size_m = std::abs(length_m);
  if (size_m < 0.01) return fmt::format("{:.2f} mm", 1000.0 * length_m);
  if (size_m < 1.0) return fmt::format("{:.2f} cm", 100.0 * length_m);
  return fmt::format("{:.2f} m", length_m);
}

}  // namespace gdtslam::reproduce
