// Distance to the map and its gradient at any point of the map frame, metres: bilinear between the centres of the
// cells. Thread-safe, constant time; a view, valid until the field changes.
#pragma once

#include <cmath>
#include <optional>

#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

class FieldGradient {
 public:
  explicit FieldGradient(const GlobalField& field)
      : cells_(field.cells()),
        geometry_(field.geometry()),
        stride_(field.stride()),
        cap_(field.cap()),
        unit_m_(field.geometry().resolution_m / 256.0) {}

  struct Value {
    double distance_m = 0.0;
    Point2 gradient{0.0, 0.0};
  };
  /// Nothing where the map knows nothing nearby.
  [[nodiscard]] std::optional<Value> at(const Point2& point) const {
    const double x = (point.x() - geometry_.origin_x_m) / geometry_.resolution_m - 0.5;
    const double y = (point.y() - geometry_.origin_y_m) / geometry_.resolution_m - 0.5;
    if (!(x >= 0.0 && y >= 0.0 && x < geometry_.width - 1 && y < geometry_.height - 1)) return std::nullopt;
    const auto column = static_cast<std::size_t>(x);
    const auto row = static_cast<std::size_t>(y);
    const std::size_t at = row * stride_ + column;
    const std::uint16_t raw[4] = {cells_[at], cells_[at + 1], cells_[at + stride_], cells_[at + stride_ + 1]};
    for (const std::uint16_t value : raw) {
      if (value >= cap_) return std::nullopt;
    }
    const double fx = x - static_cast<double>(column);
    const double fy = y - static_cast<double>(row);
    const double low = raw[0] + fx * (raw[1] - raw[0]);
    const double high = raw[2] + fx * (raw[3] - raw[2]);
    const double right = raw[1] + fy * (raw[3] - raw[1]);
    const double left = raw[0] + fy * (raw[2] - raw[0]);
    const double slope = unit_m_ / geometry_.resolution_m;
    return Value{unit_m_ * (low + fy * (high - low)), {slope * (right - left), slope * (high - low)}};
  }

 private:
  std::span<const std::uint16_t> cells_;
  GridGeometry geometry_;
  std::size_t stride_;
  std::uint16_t cap_;
  double unit_m_;
};

}  // namespace gdtslam
