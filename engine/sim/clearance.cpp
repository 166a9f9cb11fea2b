#include "clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace gdtslam::sim {
namespace {

using Footprint = std::vector<Point2>;  // convex

// The part of a convex polygon on one side of a height [Sutherland1974].
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, double height_m, double side) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& a = polygon[i];
    const Vec3& b = polygon[(i + 1) % polygon.size()];
    const double above_a = side * (a.z() - height_m);
    const double above_b = side * (b.z() - height_m);
    if (above_a >= 0.0) {
      kept.push_back(a);
    }
    if ((above_a > 0.0 && above_b < 0.0) || (above_a < 0.0 && above_b > 0.0)) {
      kept.push_back(a + (b - a) * (above_a / (above_a - above_b)));
    }
  }
  return kept;
}

double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }

double sq_norm(const Point2& a) { return a.x() * a.x() + a.y() * a.y(); }

double sq_distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Point2 along = b - a;
  const double sq_length = sq_norm(along);
  const Point2 to_p = p - a;
  const double share =
      sq_length > 0.0 ? std::clamp((to_p.x() * along.x() + to_p.y() * along.y()) / sq_length, 0.0, 1.0) : 0.0;
  return sq_norm(to_p - share * along);
}

bool is_within(const Point2& p, const Footprint& convex) {
  bool has_left = false;
  bool has_right = false;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Point2& a = convex[i];
    const double side = cross(convex[(i + 1) % convex.size()] - a, p - a);
    has_left = has_left || side > 0.0;
    has_right = has_right || side < 0.0;
  }
  return has_left != has_right;
}

double sq_distance(const Point2& p, const Footprint& convex) {
  if (is_within(p, convex)) {
    return 0.0;
  }
  double best = sq_norm(p - convex.front());
  for (std::size_t i = 0; i < convex.size(); ++i) {
    best = std::min(best, sq_distance_to_segment(p, convex[i], convex[(i + 1) % convex.size()]));
  }
  return best;
}

// The part of a triangle between the two heights, seen from above; empty when there is none.
Footprint footprint_of(const std::array<Vec3, 3>& corners, const ClearanceQuery& query) {
  Footprint footprint;
  const std::vector<Vec3> band =
      clipped(clipped({corners.begin(), corners.end()}, query.low_m, 1.0), query.high_m, -1.0);
  for (const Vec3& corner : band) {
    footprint.emplace_back(corner.x(), corner.y());
  }
  return footprint;
}

struct Rectangle {
  Point2 low;
  Point2 high;
};

Rectangle bounds_of(const std::vector<Point2>& points, double margin_m) {
  Rectangle bounds{points.front(), points.front()};
  for (const Point2& p : points) {
    bounds.low = bounds.low.cwiseMin(p);
    bounds.high = bounds.high.cwiseMax(p);
  }
  bounds.low.array() -= margin_m;
  bounds.high.array() += margin_m;
  return bounds;
}

/// The places by cells of the ground, so that a triangle only meets those near it.
class PlaceGrid {
 public:
  explicit PlaceGrid(const std::vector<Point2>& places_m) {
    for (std::uint32_t i = 0; i < places_m.size(); ++i) {
      cells_[{cell_of(places_m[i].x()), cell_of(places_m[i].y())}].push_back(i);
    }
  }

  template <class Visit>
  void visit(const Rectangle& area, const Visit& visit_place) const {
    // Rows of cells are contiguous in the map, so a wide area costs its rows and what they hold.
    const std::int64_t last_x = cell_of(area.high.x());
    const std::int64_t last_y = cell_of(area.high.y());
    auto at = cells_.lower_bound({cell_of(area.low.x()), cell_of(area.low.y())});
    while (at != cells_.end() && at->first.first <= last_x) {
      const auto [x, y] = at->first;
      if (y < cell_of(area.low.y())) {
        at = cells_.lower_bound({x, cell_of(area.low.y())});
      } else if (y > last_y) {
        at = cells_.lower_bound({x + 1, cell_of(area.low.y())});
      } else {
        std::for_each(at->second.begin(), at->second.end(), visit_place);
        ++at;
      }
    }
  }

 private:
  static std::int64_t cell_of(double value_m) {
    constexpr double kCell_m = 0.5;
    return static_cast<std::int64_t>(std::floor(value_m / kCell_m));
  }
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<std::uint32_t>> cells_;
};

}  // namespace

std::vector<double> clearances_m(const TriangleMesh& mesh, const ClearanceQuery& query,
                                 const std::vector<Point2>& places_m) {
  std::vector<double> sq_best(places_m.size(), query.limit_m * query.limit_m);
  const PlaceGrid grid(places_m);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Footprint footprint = footprint_of(mesh.corners(i), query);
    if (footprint.empty()) {
      continue;
    }
    grid.visit(bounds_of(footprint, query.limit_m), [&](std::uint32_t place) {
      sq_best[place] = std::min(sq_best[place], sq_distance(places_m[place], footprint));
    });
  }
  std::vector<double> best_m(sq_best.size());
  std::transform(sq_best.begin(), sq_best.end(), best_m.begin(), [](double sq_m) { return std::sqrt(sq_m); });
  return best_m;
}

}  // namespace gdtslam::sim
