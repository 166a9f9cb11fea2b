#include "point_to_line.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostLookedAt = 12;  // candidates to each side of the direction
constexpr double kMostReach_rad = 0.6;
constexpr double kLeastRange_m = 0.1;
// pseudo_bearing() grows by at most 1 a radian, and the sine of an angle below kMostReach_rad is more than this share
// of it.
constexpr double kRayShare = 0.9;
constexpr double kSameFace = 0.8;     // least cosine between normals
constexpr double kKernelShare = 0.3;  // scale of the kernel, as a share of the gate

/// A surface point in the frame of the fixed scan.
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
  /// Turns a direction of the fixed frame into the moving one.
  [[nodiscard]] Placed back(double nx, double ny) const {
    return {0.0, 0.0, turn_.cos * nx + turn_.sin * ny, -turn_.sin * nx + turn_.cos * ny};
  }

 private:
  double x_;
  double y_;
  SinCos<double> turn_;
};

// Looks up surface points by direction. A point beyond the field of view is on no line: the line of the last beam has
// its normal from one side alone, tilted by that beam's own noise. Points beyond it would pull scans onto each other,
// by 0.1 per cent of the way along a corridor. Successive queries lie near each other, so each search starts where the
// last one ended.
class SurfaceLookup {
 public:
  explicit SurfaceLookup(const std::vector<SurfacePoint>& surface) : surface_(surface) {}

  /// The nearest point within the gate in about the same direction; null if there is none, and outside the field of
  /// view.
  const SurfacePoint* nearest(const Placed& q, double most_m) {
    const double range_squared = q.x * q.x + q.y * q.y;
    const double direction = pseudo_bearing(q.x, q.y);
    const double reach = std::min(kMostReach_rad, most_m / std::max(kLeastRange_m, std::sqrt(range_squared)));
    const std::size_t at = go_to(direction);
    if (!is_in_view(direction, at)) return nullptr;
    const SurfacePoint* best = nullptr;
    double least = most_m * most_m;
    // Returns false if neither this point nor one beyond it can be nearer: all lie beyond a ray at this angle.
    const auto look = [&](const SurfacePoint& p, double apart) {
      const double ray = kRayShare * apart;
      if (!(apart <= reach) || ray * ray * range_squared >= least) return false;
      const double dx = static_cast<double>(p.x_m) - q.x;
      const double dy = static_cast<double>(p.y_m) - q.y;
      const double square = dx * dx + dy * dy;
      if (square < least) {
        least = square;
        best = &p;
      }
      return true;
    };
    const std::size_t last = at + std::min(kMostLookedAt, surface_.size() - at);
    for (std::size_t k = at; k != last && look(surface_[k], stored(k) - direction);) ++k;
    const std::size_t first = at - std::min(kMostLookedAt, at);
    for (std::size_t k = at; k != first && look(surface_[k - 1], direction - stored(k - 1));) --k;
    return best;
  }

 private:
  [[nodiscard]] double stored(std::size_t k) const { return surface_[k].direction; }

  // Up to half a beam beyond the first and the last; `at` is the first point whose direction is not less.
  [[nodiscard]] bool is_in_view(double direction, std::size_t at) const {
    const std::size_t count = surface_.size();
    if (count < 2) return true;
    if (at == 0) return stored(0) - direction <= 0.5 * (stored(1) - stored(0));
    return at < count || direction - stored(count - 1) <= 0.5 * (stored(count - 1) - stored(count - 2));
  }

  // Finds the first point whose direction is not less: in doubling steps from the last position, then by halves.
  std::size_t go_to(double direction) {
    std::size_t low = 0;
    std::size_t high = surface_.size();
    if (at_ < high && stored(at_) < direction) {
      low = at_ + 1;
      for (std::size_t step = 1; low + step < high; step *= 2) {
        if (!(stored(low + step) < direction)) {
          high = low + step;
          break;
        }
        low += step + 1;
      }
    } else {
      high = at_;
      for (std::size_t step = 1; step < high; step *= 2) {
        if (stored(high - step) < direction) {
          low = high - step + 1;
          break;
        }
        high -= step;
      }
    }
    while (low < high) {
      const std::size_t middle = low + (high - low) / 2;
      if (stored(middle) < direction) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return at_ = low;
  }

  const std::vector<SurfacePoint>& surface_;
  std::size_t at_ = 0;
};

}  // namespace

LineEquations line_equations(const KeptScan& fixed, const KeptScan& moving, const Pose2& T_fixed_moving,
                             const LineGate& gate) {
  LineEquations sum;
  const Motion motion(T_fixed_moving);
  const double scale_m = kKernelShare * gate.most_m;
  SurfaceLookup lookup(fixed.surface);
  const std::size_t step = std::max<std::size_t>(1, moving.surface.size() / gate.points);
  for (std::size_t i = 0; i < moving.surface.size(); i += step) {
    const SurfacePoint& p = moving.surface[i];
    const Placed q = motion(p);
    const SurfacePoint* line = lookup.nearest(q, gate.most_m);
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
