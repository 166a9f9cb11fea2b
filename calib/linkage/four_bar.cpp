#include "gdtslam/calib/four_bar.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

/// Tolerance of the loop's domain, as a share of the squared size: rounding of a loop that just closes.
constexpr double kDomainSlack = 1e-12;
/// Below this sine of the transmission angle rounding dominates the rates.
constexpr double kLeastSine = 1e-7;

double bar_sum(const FourBar& bars) { return bars.crank_m + bars.coupler_m + bars.rocker_m + bars.ground_m; }

/// The loop at one crank angle: unit vectors along the bars and the sine of the angle from coupler to rocker.
struct Loop {
  Point2 crank;
  Point2 coupler;
  Point2 rocker;
  double sine = 0.0;
  double cosine = 0.0;
};

/// The triangle A, B, rocker's pivot: B is `along` the line from A to the pivot and `across` it.
std::optional<Loop> close_loop(const FourBar& bars, Assembly assembly, double crank_rad) {
  const auto [sin, cos] = sin_cos(crank_rad);
  const Point2 crank(cos, sin);
  const Point2 diagonal = Point2(bars.ground_m, 0.0) - bars.crank_m * crank;
  const double sq_diagonal = diagonal.x() * diagonal.x() + diagonal.y() * diagonal.y();
  const double longest = bars.coupler_m + bars.rocker_m;
  const double shortest = bars.coupler_m - bars.rocker_m;
  const double room_outside = longest * longest - sq_diagonal;
  const double room_inside = sq_diagonal - shortest * shortest;
  const double slack = kDomainSlack * bar_sum(bars) * bar_sum(bars);
  if (!(room_outside >= -slack && room_inside >= -slack && sq_diagonal > slack)) {
    return std::nullopt;  // also for lengths and angles that are not finite
  }
  const double length = std::sqrt(sq_diagonal);
  const double area4 = std::sqrt(std::max(room_outside, 0.0) * std::max(room_inside, 0.0));  // four times the triangle
  const double side = assembly == Assembly::kOpen ? 1.0 : -1.0;
  const double along = (sq_diagonal + longest * shortest) / (2.0 * length);
  const double across = side * area4 / (2.0 * length);
  const Point2 ahead = diagonal / length;
  const Point2 left(-ahead.y(), ahead.x());
  Loop loop;
  loop.crank = crank;
  loop.coupler = (along * ahead + across * left) / bars.coupler_m;
  loop.rocker = ((along - length) * ahead + across * left) / bars.rocker_m;
  const double product2 = 2.0 * bars.coupler_m * bars.rocker_m;
  loop.sine = side * area4 / product2;
  loop.cosine = (bars.coupler_m * bars.coupler_m + bars.rocker_m * bars.rocker_m - sq_diagonal) / product2;
  return loop;
}

double cross(const Point2& a, const Point2& b) { return a.x() * b.y() - a.y() * b.x(); }
double dot(const Point2& a, const Point2& b) { return a.x() * b.x() + a.y() * b.y(); }

/// Empty if the rocker's angle has no derivative.
std::optional<Loop> smooth_loop(const FourBar& bars, Assembly assembly, double crank_rad) {
  std::optional<Loop> loop = close_loop(bars, assembly, crank_rad);
  return loop && std::fabs(loop->sine) >= kLeastSine ? loop : std::nullopt;
}

/// The angle in [0, pi] of a cosine within its domain.
double arc_cosine(double cosine) { return atan2(std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine))), cosine); }

}  // namespace

std::optional<LinkagePose> solve(const FourBar& bars, Assembly assembly, double crank_rad) {
  const std::optional<Loop> loop = close_loop(bars, assembly, crank_rad);
  if (!loop) {
    return std::nullopt;
  }
  const double rocker_rad = atan2(loop->rocker.y(), loop->rocker.x());
  return LinkagePose{.coupler_rad = atan2(loop->coupler.y(), loop->coupler.x()),
                     .rocker_rad = rocker_rad == -kPi ? kPi : rocker_rad,
                     .transmission_rad = atan2(std::fabs(loop->sine), std::fabs(loop->cosine))};
}

// The loop crank + coupler = ground + rocker, differentiated once and twice and multiplied by the unit vectors of the
// rocker and of the coupler, which leaves one unknown in each equation.
std::optional<LinkageMotion> motion(const FourBar& bars, Assembly assembly, double crank_rad, double crank_rate,
                                    double crank_acceleration) {
  const std::optional<Loop> loop = smooth_loop(bars, assembly, crank_rad);
  if (!loop) {
    return std::nullopt;
  }
  const auto& [crank, coupler, rocker, sine, cosine] = *loop;
  LinkageMotion result;
  const double coupler_gain = bars.crank_m * cross(rocker, crank) / (bars.coupler_m * sine);
  const double rocker_gain = bars.crank_m * cross(coupler, crank) / (bars.rocker_m * sine);
  result.coupler_rate = crank_rate * coupler_gain;
  result.rocker_rate = crank_rate * rocker_gain;
  const double crank_pull = bars.crank_m * crank_rate * crank_rate;
  const double coupler_pull = bars.coupler_m * result.coupler_rate * result.coupler_rate;
  const double rocker_pull = bars.rocker_m * result.rocker_rate * result.rocker_rate;
  result.coupler_acceleration =
      crank_acceleration * coupler_gain +
      (crank_pull * dot(crank, rocker) + coupler_pull * cosine - rocker_pull) / (bars.coupler_m * sine);
  result.rocker_acceleration =
      crank_acceleration * rocker_gain +
      (crank_pull * dot(crank, coupler) + coupler_pull - rocker_pull * cosine) / (bars.rocker_m * sine);
  return result;
}

// The loop differentiated by each length and multiplied by the unit vector of the coupler.
std::optional<RockerSensitivity> sensitivity(const FourBar& bars, Assembly assembly, double crank_rad) {
  const std::optional<Loop> loop = smooth_loop(bars, assembly, crank_rad);
  if (!loop) {
    return std::nullopt;
  }
  const double arm = bars.rocker_m * loop->sine;
  return RockerSensitivity{.crank = -dot(loop->crank, loop->coupler) / arm,
                           .coupler = -1.0 / arm,
                           .rocker = loop->cosine / arm,
                           .ground = loop->coupler.x() / arm};
}

std::optional<Point2> coupler_point(const FourBar& bars, Assembly assembly, double crank_rad, double along_m,
                                    double across_m) {
  const std::optional<Loop> loop = close_loop(bars, assembly, crank_rad);
  if (!loop) {
    return std::nullopt;
  }
  const Point2 left(-loop->coupler.y(), loop->coupler.x());
  return Point2(bars.crank_m * loop->crank + along_m * loop->coupler + across_m * left);
}

// The distance from A to the rocker's pivot must lie between |coupler - rocker| and coupler + rocker.
std::vector<CrankRange> crank_ranges(const FourBar& bars) {
  if (!violations(bars).empty()) {
    return {};
  }
  const double sq_sum = bars.crank_m * bars.crank_m + bars.ground_m * bars.ground_m;
  const double product2 = 2.0 * bars.crank_m * bars.ground_m;
  const auto cosine_at = [&](double diagonal) { return (sq_sum - diagonal * diagonal) / product2; };
  const double least_cosine = cosine_at(bars.coupler_m + bars.rocker_m);
  const double most_cosine = cosine_at(bars.coupler_m - bars.rocker_m);
  const bool reaches_inside = most_cosine >= 1.0;
  const bool reaches_outside = least_cosine <= -1.0;
  const double inner = reaches_inside ? 0.0 : arc_cosine(most_cosine);
  const double outer = reaches_outside ? kPi : arc_cosine(std::min(least_cosine, 1.0));
  if (reaches_inside && reaches_outside) {
    return {{.from_rad = 0.0, .to_rad = kTwoPi}};
  }
  if (reaches_inside) {
    return {{.from_rad = -outer, .to_rad = outer}};
  }
  if (reaches_outside) {
    return {{.from_rad = inner, .to_rad = kTwoPi - inner}};
  }
  return {{.from_rad = inner, .to_rad = outer}, {.from_rad = -outer, .to_rad = -inner}};
}

FreudensteinCoefficients freudenstein(const FourBar& bars) {
  const double sq_sum = bars.crank_m * bars.crank_m - bars.coupler_m * bars.coupler_m + bars.rocker_m * bars.rocker_m +
                        bars.ground_m * bars.ground_m;
  return {.k1 = bars.ground_m / bars.crank_m,
          .k2 = bars.ground_m / bars.rocker_m,
          .k3 = sq_sum / (2.0 * bars.crank_m * bars.rocker_m)};
}

}  // namespace gdtslam::calib
