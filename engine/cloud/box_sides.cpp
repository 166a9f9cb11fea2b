#include <algorithm>
#include <cmath>
#include <vector>

#include "box_face.hpp"

namespace gdtslam {
namespace {

constexpr double kAside_m = 0.06;       // a side face stays within this of the end
constexpr double kMostSlope = 0.3;      // away from a right angle
constexpr double kLeastDepth_m = 0.04;  // least depth seen
constexpr double kMostGap_m = 0.2;      // largest gap along its depth
constexpr double kMostRms_m = 0.015;
constexpr std::size_t kLeastPoints = 20;
constexpr int kRefits = 6;

struct SidePoint {
  double depth_m;
  double along_m;
};

/// along = at + slope * depth by least squares.
struct SideLine {
  double at_m = 0.0;
  double slope = 0.0;
  double rms_m = 0.0;
  double sigma_at_m = 0.0;
  double sigma_slope = 0.0;
  [[nodiscard]] double residual(const SidePoint& p) const { return p.along_m - at_m - slope * p.depth_m; }
};

// The depth at which a point's beam crosses the line: independent of the range's error.
double crossing_m(const SidePoint& p, const SideLine& line, const EndPlace& place) {
  if (!place.eye_along_m) return p.depth_m;
  const double eye_depth_m = -place.eye_before_m;
  const double from_line = *place.eye_along_m - line.at_m - line.slope * eye_depth_m;
  const double approach = p.along_m - *place.eye_along_m - line.slope * (p.depth_m - eye_depth_m);
  const double share = -from_line / approach;
  constexpr double kMostChange = 0.2;  // a beam along the line crosses it anywhere
  if (!(std::fabs(share - 1.0) <= kMostChange)) return p.depth_m;
  return eye_depth_m + share * (p.depth_m - eye_depth_m);
}

// One step of Gauss-Newton from `last`.
SideLine line_through(std::vector<SidePoint> points, const SideLine& last, const EndPlace& place) {
  for (SidePoint& p : points) {
    const double depth_m = crossing_m(p, last, place);
    p = {depth_m, last.at_m + last.slope * depth_m + last.residual(p)};
  }
  const auto count = static_cast<double>(points.size());
  double depth_m = 0.0;
  double along_m = 0.0;
  for (const SidePoint& p : points) {
    depth_m += p.depth_m / count;
    along_m += p.along_m / count;
  }
  double spread = 0.0;
  double product = 0.0;
  for (const SidePoint& p : points) {
    spread += (p.depth_m - depth_m) * (p.depth_m - depth_m);
    product += (p.depth_m - depth_m) * (p.along_m - along_m);
  }
  SideLine line;
  line.slope = spread > 0.0 ? product / spread : 0.0;
  line.at_m = along_m - line.slope * depth_m;
  double sum = 0.0;
  for (const SidePoint& p : points) sum += line.residual(p) * line.residual(p);
  line.rms_m = std::sqrt(sum / std::max(1.0, count - 2.0));
  line.sigma_slope = spread > 0.0 ? line.rms_m / std::sqrt(spread) : 0.0;
  line.sigma_at_m =
      std::sqrt(line.rms_m * line.rms_m / count + line.sigma_slope * line.sigma_slope * depth_m * depth_m);
  return line;
}

// Sorts by depth, up to the first gap.
void cut_at_gap(std::vector<SidePoint>& points) {
  const auto by_depth = [](const SidePoint& a, const SidePoint& b) { return a.depth_m < b.depth_m; };
  std::sort(points.begin(), points.end(), by_depth);
  double last_m = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (points[k].depth_m - last_m > kMostGap_m) {
      points.resize(k);
      return;
    }
    last_m = points[k].depth_m;
  }
}

double median_along(std::vector<SidePoint> points) {
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  std::nth_element(points.begin(), middle, points.end(),
                   [](const SidePoint& a, const SidePoint& b) { return a.along_m < b.along_m; });
  return middle->along_m;
}

}  // namespace

// Takes the points behind the face and close to its end, without those that are not on the line of most points.
std::optional<SideFace> side_at(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m,
                                double max_depth_m) {
  std::vector<SidePoint> near;
  for (const FaceHit& hit : hits) {
    const bool is_behind = hit.depth_m > thickness_m && hit.depth_m < max_depth_m;
    if (!is_behind || !place.beside.has(hit.point_beside(place.axis))) continue;
    const double along_m = hit.point_along(place.axis);
    if (std::fabs(along_m - place.rough_m) <= kAside_m) near.push_back({hit.depth_m, along_m});
  }
  cut_at_gap(near);
  if (near.size() < kLeastPoints) return std::nullopt;
  SideLine line;
  line.at_m = median_along(near);
  double within_m = 0.5 * kAside_m;
  std::vector<SidePoint> kept;
  for (int k = 0; k < kRefits; ++k) {
    kept.clear();
    for (const SidePoint& p : near) {
      // Selected by its beam's crossing of the side: selecting by its own depth would favour errors away from the face.
      if (std::fabs(line.residual(p)) <= within_m && crossing_m(p, line, place) > 2.0 * thickness_m) kept.push_back(p);
    }
    cut_at_gap(kept);
    if (kept.size() < kLeastPoints || kept.back().depth_m - kept.front().depth_m < kLeastDepth_m) return std::nullopt;
    line = line_through(kept, line, place);
    within_m = std::max(1.0e-3, 3.0 * line.rms_m);
  }
  if (std::fabs(line.slope) > kMostSlope || line.rms_m > kMostRms_m) return std::nullopt;
  SideFace side;
  side.crease = {line.at_m, line.sigma_at_m, EndKind::kCrease};
  side.slope = line.slope;
  side.sigma_slope = line.sigma_slope;
  side.rms_m = line.rms_m;
  side.deepest_m = kept[kept.size() - 1 - kept.size() / 50].depth_m;
  side.points = static_cast<std::uint32_t>(kept.size());
  return side;
}

}  // namespace gdtslam
