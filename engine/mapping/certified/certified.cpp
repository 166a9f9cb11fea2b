#include "gdtslam/mapping/certified.hpp"

#include <array>
#include <cmath>
#include <string>

#include "device.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "field.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "search.hpp"

namespace gdtslam {
namespace {

// True if the two outermost rows and columns hold the cap, so that points off the map read it.
bool edge_holds_cap(const FieldView& field) {
  const auto at = [&](std::size_t x, std::size_t y) { return field.cells[y * field.stride + x]; };
  for (const std::size_t off : {std::size_t{0}, std::size_t{1}}) {
    for (std::size_t x = 0; x < field.width; ++x) {
      if (at(x, off) != field.cap || at(x, field.height - 1 - off) != field.cap) return false;
    }
    for (std::size_t y = 0; y < field.height; ++y) {
      if (at(off, y) != field.cap || at(field.width - 1 - off, y) != field.cap) return false;
    }
  }
  return true;
}

void require(bool holds, const std::string& what) {
  if (!holds) throw InputError("certified matching: " + what);
}

const FieldView& checked(const FieldView& field) {
  require(field.width >= 4 && field.height >= 4 && field.stride >= field.width,
          "the field is smaller than 4 x 4 cells");
  require(field.cap > 0, "the field's cap is 0");
  require(std::isfinite(field.resolution_m) && field.resolution_m > 0.0, "the field's resolution is not positive");
  require(edge_holds_cap(field), "the two outermost rows and columns of the field do not hold the cap");
  return field;
}

bool is_length(double value) { return std::isfinite(value) && value >= 0.0; }

void check(std::span<const PointCells> points, const PoseWindow& window, const CertifiedOptions& options) {
  require(!points.empty(), "the scan has no returns");
  require(points.size() <= kMostCertifiedPoints, "the scan has " + std::to_string(points.size()) +
                                                     " returns, more than " + std::to_string(kMostCertifiedPoints));
  for (const PointCells& point : points) {
    require(std::isfinite(point.x) && std::isfinite(point.y), "a return of the scan is not finite");
  }
  require(window.centre.is_finite() && is_length(window.half_x_m) && is_length(window.half_y_m) &&
              window.half_theta_rad >= 0.0,
          "the window is not finite");
  require(is_length(options.gap_m), "the gap is not a length");
  for (const Pose2& start : options.starts) require(start.is_finite(), "a start is not finite");
  if (options.prior) {
    const WindowPrior& prior = *options.prior;
    require(prior.mean.is_finite() && std::isfinite(prior.weight_xy) && prior.weight_xy >= 0.0F &&
                std::isfinite(prior.weight_theta) && prior.weight_theta >= 0.0F && prior.limit >= 0.0F &&
                prior.limit <= 1.0e9F,
            "the prior is not finite");
  }
}

}  // namespace

FieldCopy::FieldCopy(const GlobalField& map)
    : geometry_(map.geometry()), first_cell_(map.box().min), cap_(map.cap()), cells_(map.download()) {}

FieldView FieldCopy::view() const {
  return {.cells = cells_.data(),
          .width = static_cast<std::uint32_t>(geometry_.width),
          .height = static_cast<std::uint32_t>(geometry_.height),
          .stride = static_cast<std::uint32_t>(geometry_.width),
          .first_cell = first_cell_,
          .cap = cap_,
          .resolution_m = geometry_.resolution_m};
}

CertifiedMap::CertifiedMap(const FieldView& field, Isa isa, Windows windows, Backend* device)
    : field_(checked(field)), isa_(isa), bounds_(std::make_unique<BoundFields>(field, isa, windows)) {
  if (device != nullptr) device_ = std::make_unique<DeviceBounds>(*device, *bounds_);
}
CertifiedMap::~CertifiedMap() = default;
std::uint64_t CertifiedMap::device_launches() const { return device_ != nullptr ? device_->launches() : 0; }
std::size_t CertifiedMap::bytes() const { return bounds_->bytes(); }
std::uint64_t CertifiedMap::most_bytes(std::uint64_t width, std::uint64_t height, Windows windows) {
  return BoundFields::most_bytes(width, height, windows);
}

bool PoseWindow::holds(const Pose2& pose) const {
  return std::fabs(pose.x_m - centre.x_m) <= half_x_m && std::fabs(pose.y_m - centre.y_m) <= half_y_m &&
         (half_theta_rad >= kPi || std::fabs(wrap_angle(pose.theta_rad - centre.theta_rad)) <= half_theta_rad);
}

bool ExcludedPoses::hold(const Pose2& pose) const {
  const double dx = pose.x_m - around.x_m;
  const double dy = pose.y_m - around.y_m;
  return dx * dx + dy * dy < within_m * within_m &&
         std::fabs(wrap_angle(pose.theta_rad - around.theta_rad)) < within_rad;
}

std::string_view to_string(CertifiedStop stop) {
  static constexpr std::array<std::string_view, 6> kNames{"gap-reached", "bound-reached", "box-limit",
                                                          "time-limit",  "resolution",    "nothing-allowed"};
  static_assert(kNames.size() == static_cast<std::size_t>(CertifiedStop::kNothingAllowed) + 1);
  return kNames.at(static_cast<std::size_t>(stop));
}

CertifiedResult find_pose(const CertifiedMap& map, std::span<const PointCells> points, const PoseWindow& window,
                          const CertifiedOptions& options) {
  check(points, window, options);
  return CertifiedSearch(map, points, window, options).run();
}

}  // namespace gdtslam
