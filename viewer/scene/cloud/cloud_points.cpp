#include "cloud_points.hpp"

#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cloud_points_prop.hpp"
#include "engine/cloud/position_of.hpp"
#include "viewer/scene/camera_basis.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPiece = 1U << 16U;

double stamp_for_order(const CloudPoint& point) {
  return std::isnan(point.stamp_s) ? -std::numeric_limits<double>::infinity() : point.stamp_s;
}

// When the points of a piece were measured.
struct PieceTimes {
  PieceTimes(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn) : count(drawn.size()) {
    first_s = stamp_for_order(cloud[drawn.front()]);
    span_s = stamp_for_order(cloud[drawn.back()]) - first_s;
    if (!(span_s > 0.0) || !std::isfinite(span_s)) {
      span_s = 0.0;  // without times, or endless: shown as a whole
      return;
    }
    ticks.resize(count);
    for (std::size_t k = 0; k < count; ++k) ticks[k] = tick_of(cloud[drawn[k]].stamp_s);
  }

  [[nodiscard]] std::uint32_t tick_of(double stamp_s) const {
    constexpr auto kMost = static_cast<double>(std::numeric_limits<std::uint32_t>::max());
    return static_cast<std::uint32_t>(std::floor((stamp_s - first_s) / span_s * kMost));
  }
  [[nodiscard]] std::size_t count_until(double stamp_s) const {
    if (stamp_s < first_s) return 0;
    if (ticks.empty() || stamp_s >= first_s + span_s) return count;
    return static_cast<std::size_t>(std::upper_bound(ticks.begin(), ticks.end(), tick_of(stamp_s)) - ticks.begin());
  }

  std::size_t count = 0;
  double first_s = 0.0;
  double span_s = 0.0;
  std::vector<std::uint32_t> ticks;  // of the points' stamps within the span; empty where all are one
};

void sort_by_time(std::span<const CloudPoint> cloud, std::vector<std::uint32_t>& drawn) {
  const auto is_before = [&cloud](std::uint32_t a, std::uint32_t b) {
    return stamp_for_order(cloud[a]) < stamp_for_order(cloud[b]);
  };
  if (!std::is_sorted(drawn.begin(), drawn.end(), is_before)) std::stable_sort(drawn.begin(), drawn.end(), is_before);
}

}  // namespace

struct CloudPoints::State {
  vtkNew<CloudPointsProp> prop;
  std::vector<PieceTimes> pieces;
  std::uint64_t shown = 0;
};

CloudPoints::CloudPoints(vtkRenderer& renderer) : state_(std::make_unique<State>()) {
  renderer.AddViewProp(state_->prop);
}

CloudPoints::~CloudPoints() = default;

void CloudPoints::set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const DotOf& dot_of) {
  State& s = *state_;
  sort_by_time(cloud, drawn);
  const Point3 origin = position_of(cloud[drawn.front()]);
  s.prop->set_origin(origin);
  const std::span<const std::uint32_t> all(drawn);
  for (std::size_t begin = 0; begin < all.size(); begin += kPiece) {
    const auto part = all.subspan(begin, std::min(kPiece, all.size() - begin));
    std::vector<DotVertex> dots;
    dots.reserve(part.size());
    for (const std::uint32_t k : part) {
      const Dot dot = dot_of(k);
      const Eigen::Vector3f place = (position_of(cloud[k]) - origin).cast<float>();
      dots.push_back({.place = {place.x(), place.y(), place.z()},
                      .colour = {dot.colour.red, dot.colour.green, dot.colour.blue},
                      .size_code = diameter_code(dot.diameter_m)});
    }
    s.prop->add_piece(std::move(dots));
    s.pieces.emplace_back(cloud, part);
  }
  s.shown = drawn.size();
}

void CloudPoints::show_until(double stamp_s) {
  State& s = *state_;
  s.shown = 0;
  for (std::size_t k = 0; k < s.pieces.size(); ++k) {
    const std::size_t count = s.pieces[k].count_until(stamp_s);
    s.prop->show(k, count);
    s.shown += count;
  }
}

void CloudPoints::set_sizes(const PointSizes& sizes, const Camera& camera, const PictureSize& size) {
  const double samples = sizes.samples;
  const double visible_m = camera.is_parallel ? camera.parallel_height_m : 2.0 * half_height_slope(camera);
  const bool is_fixed = sizes.fixed_px > 0.0;
  state_->prop->set_sizes(samples * size.height / visible_m, samples * (is_fixed ? sizes.fixed_px : sizes.least_px),
                          samples * (is_fixed ? sizes.fixed_px : sizes.largest_px));
}

void CloudPoints::keep_in_view(const std::optional<Point3>& place) { state_->prop->keep_in_view(place); }

std::uint64_t CloudPoints::shown() const { return state_->shown; }

}  // namespace gdtslam
