// Cameras as text.
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kForm = "EYE_X,EYE_Y,EYE_Z,TARGET_X,TARGET_Y,TARGET_Z[,ANGLE]";
constexpr double kFarthest_m = 1e6;

[[noreturn]] void fail_camera(const std::string& text, const std::string& what) {
  throw UsageError(fmt::format("camera '{}': {}; give {}, for example 20,-30,25,0,0,0,35", text, what, kForm));
}

std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t comma = text.find(',', begin);
    std::string_view part = text.substr(begin, comma == std::string_view::npos ? comma : comma - begin);
    while (part.starts_with(' ')) part.remove_prefix(1);
    while (part.ends_with(' ')) part.remove_suffix(1);
    parts.push_back(part);
    if (comma == std::string_view::npos) return parts;
    begin = comma + 1;
  }
}

double number_of(std::string_view part, const std::string& text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
  if (error != std::errc{} || end != part.data() + part.size())
    fail_camera(text, fmt::format("'{}' is not a number", part));
  if (!(std::fabs(value) <= kFarthest_m))
    fail_camera(text, fmt::format("'{}' is beyond {} km", part, kFarthest_m / 1000.0));
  return value;
}

void read_opening(std::string_view part, const std::string& text, Camera& camera) {
  if (part.ends_with('m')) {
    camera.is_parallel = true;
    camera.parallel_height_m = number_of(part.substr(0, part.size() - 1), text);
    if (camera.parallel_height_m < 0.001) fail_camera(text, "a parallel camera must show at least 0.001 m");
    return;
  }
  const double angle_deg = number_of(part, text);
  if (angle_deg < 0.1 || angle_deg > 170.0) {
    fail_camera(text, fmt::format("the view angle {} is not between 0.1 and 170 degrees", part));
  }
  camera.view_angle_rad = rad_from_deg(angle_deg);
}

}  // namespace

Camera parse_camera(const std::string& text) {
  const std::vector<std::string_view> parts = parts_of(text);
  if (parts.size() != 6 && parts.size() != 7) {
    fail_camera(text, fmt::format("{} number{} where 6 or 7 are needed", parts.size(), parts.size() == 1 ? "" : "s"));
  }
  std::array<double, 6> numbers{};
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = number_of(parts[k], text);
  Camera camera;
  camera.eye = {numbers[0], numbers[1], numbers[2]};
  camera.target = {numbers[3], numbers[4], numbers[5]};
  const Point3 sight = camera.target - camera.eye;
  if (sight.norm() < 1e-3) fail_camera(text, "eye and target are at one place");
  const double level_m = std::sqrt(sight.x() * sight.x() + sight.y() * sight.y());
  if (level_m < 1e-6 * sight.norm()) camera.up = Point3::UnitY();
  if (parts.size() == 7) read_opening(parts[6], text, camera);
  return camera;
}

}  // namespace gdtslam
