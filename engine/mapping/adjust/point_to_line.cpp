#include "point_to_line.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr std::ptrdiff_t kMostLookedAt = 12;  // to each side of the direction
constexpr double kMostReach_rad = 0.6;
constexpr double kLeastRange_m = 0.1;
constexpr double kSameFace = 0.8;     // least cosine between normals
constexpr double kKernelShare = 0.3;  // of the gate: the scale of the kernel

double stored_direction(const SurfacePoint& p) { return p.direction; }

/// A surface point in the frame of the scan that stands still.
struct Placed {
  double x = 0.0, y = 0.0, normal_x = 0.0, normal_y = 0.0;
};

class Motion {
 public:
  explicit Motion(const Pose2& T) : x_(T.x_m), y_(T.y_m), turn_(sin_cos(T.theta_rad)) {}
  [[nodiscard]] Placed operator()(const SurfacePoint& p) const {
    const double px = p.x_m;
    const double py = p.y_m;
    const double nx = p.normal_x;
    const double ny = p.normal_y;
    return {turn_.cos * px - turn_.sin * py + x_, turn_.sin * px + turn_.cos * py + y_, turn_.cos * nx - turn_.sin * ny,
            turn_.sin * nx + turn_.cos * ny};
  }
  /// A direction of the fixed frame in the moving one.
  [[nodiscard]] Placed back(double nx, double ny) const {
    return {0.0, 0.0, turn_.cos * nx + turn_.sin * ny, -turn_.sin * nx + turn_.cos * ny};
  }

 private:
  double x_;
  double y_;
  SinCos<double> turn_;
};

// The nearest point within the gate among those in about the same direction; null where there is none.
const SurfacePoint* nearest(const std::vector<SurfacePoint>& surface, const Placed& q, double most_m) {
  const double range_m = std::max(kLeastRange_m, std::sqrt(q.x * q.x + q.y * q.y));
  const double direction = direction_of(q.x, q.y);
  const double reach = std::min(kMostReach_rad, most_m / range_m);
  const auto at = std::lower_bound(surface.begin(), surface.end(), direction,
                                   [](const SurfacePoint& p, double value) { return stored_direction(p) < value; });
  const SurfacePoint* best = nullptr;
  double least = most_m * most_m;
  const auto look = [&](const SurfacePoint& p) {
    const double dx = static_cast<double>(p.x_m) - q.x;
    const double dy = static_cast<double>(p.y_m) - q.y;
    const double square = dx * dx + dy * dy;
    if (square >= least) return;
    least = square;
    best = &p;
  };
  const auto last = at + std::min(kMostLookedAt, surface.end() - at);
  for (auto it = at; it != last && stored_direction(*it) - direction <= reach; ++it) look(*it);
  const auto first = at - std::min(kMostLookedAt, at - surface.begin());
  for (auto it = at; it != first && direction - stored_direction(*std::prev(it)) <= reach;) look(*--it);
  return best;
}

}  // namespace

LineEquations line_equations(const KeptScan& fixed, const KeptScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate) {
  LineEquations sum;
  const Motion motion(T_fixed_moving);
  const double scale_m = kKernelShare * gate.most_m;
  const std::size_t step = std::max<std::size_t>(1, moving.surface.size() / gate.points);
  for (std::size_t i = 0; i < moving.surface.size(); i += step) {
    const SurfacePoint& p = moving.surface[i];
    const Placed q = motion(p);
    const SurfacePoint* line = nearest(fixed.surface, q, gate.most_m);
    if (line == nullptr) continue;
    const double nx = line->normal_x;
    const double ny = line->normal_y;
    if (nx * q.normal_x + ny * q.normal_y < kSameFace) continue;
    const double off = nx * (q.x - static_cast<double>(line->x_m)) + ny * (q.y - static_cast<double>(line->y_m));
    const Placed n = motion.back(nx, ny);
    const Tangent2 J{n.normal_x, n.normal_y,
                     static_cast<double>(p.x_m) * n.normal_y - static_cast<double>(p.y_m) * n.normal_x};
    const double share = 1.0 / (1.0 + off * off / (scale_m * scale_m));
    const double weight = share * share;  // Geman and McClure
    sum.information += weight * outer(J, J);
    for (std::size_t k = 0; k < 3; ++k) sum.gradient[k] += weight * off * J[k];
    sum.weight += weight;
    sum.cost_m2 += weight * off * off;
  }
  return sum;
}

}  // namespace gdtslam
