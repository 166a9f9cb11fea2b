#include "surface_points.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostNeighbours = 8;  // on each side
constexpr std::size_t kFewestPoints = 4;
constexpr double kReachShare = 0.05;  // share of the range: neighbours at a grazing angle lie far apart
constexpr double kReachNexts = 3.5;   // and of the next point's distance: beams may be few
constexpr double kLeastReach_m = 0.12;
constexpr double kMostReach_m = 0.5;
constexpr double kFlatness = 0.05;          // most of the variance across, as a share of that along
constexpr double kRoughness_m = 0.01;       // and beyond that share: a laser's noise
constexpr double kReachNoises = 10.0;       // neighbours within this many times the noise err by six degrees
constexpr double kRoughnessNoises = 1.3;    // multiple of the noise, which a small sample exceeds
constexpr std::size_t kFewestOfNoise = 10;  // returns with neighbours
constexpr double kMedianOfNormal = 0.6745;  // median of the absolute value of a normal variable
constexpr double kTiniest = 1.0e-12;        // least eigenvalue that is divided by
constexpr double kLonePlace_m = 0.5;        // spacing of beams without neighbours
constexpr double kCornerPlace_m = 0.1;      // distance of a corner from the beams at its sides
constexpr double kMostLone = 20.0;          // independent points
constexpr double kSurfaceEnough = 20.0;     // points on surfaces that make lone ones needless, except corners
constexpr double kOffLine_m = 0.05;
constexpr double kOffLineNoises = 3.0;
constexpr double kAcross = 0.5;        // least squared cosine between a normal and the way: 45 degrees
constexpr double kEnoughAcross = 0.1;  // share of the surface

// Sums over the neighbours of a point, relative to the point.
struct Neighbourhood {
  std::size_t count = 0;
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double dx, double dy) {
    ++count;
    x += dx;
    y += dy;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
};

Neighbourhood sum_neighbours(std::span<const Point2> points, std::size_t at, double noise_m) {
  const double px = points[at].x();
  const double py = points[at].y();
  const auto away_m = [&](std::size_t other) { return (points[other] - points[at]).norm(); };
  const double next_m = std::min(at > 0 ? away_m(at - 1) : kMostReach_m,  //
                                 at + 1 < points.size() ? away_m(at + 1) : kMostReach_m);
  const double usual_m = kReachShare * std::sqrt(px * px + py * py);
  const double reach_m =
      std::clamp(std::max({usual_m, kReachNexts * next_m, kReachNoises * noise_m}), kLeastReach_m, kMostReach_m);
  Neighbourhood sums;
  sums.add(0.0, 0.0);
  const auto take = [&](std::size_t neighbour) {
    const double dx = points[neighbour].x() - px;
    const double dy = points[neighbour].y() - py;
    if (dx * dx + dy * dy >= reach_m * reach_m) return false;
    sums.add(dx, dy);
    return true;
  };
  for (std::size_t k = 1; k <= kMostNeighbours && k <= at && take(at - k); ++k) continue;
  for (std::size_t k = 1; k <= kMostNeighbours && at + k < points.size() && take(at + k); ++k) continue;
  return sums;
}

/// The axis across a flat neighbourhood, and the variance of its direction, rad^2.
struct Normal {
  Point2 axis;
  double variance = 0.0;
};

// The direction a quarter turn from half the angle with this cosine and sine. The smaller part follows from the larger.
Point2 across_axis(double cosine, double sine) {
  const double larger = std::sqrt(0.5 * (1.0 + std::fabs(cosine)));
  const double smaller = 0.5 * sine / larger;
  return cosine >= 0.0 ? Point2(-smaller, larger) : Point2(-std::copysign(larger, sine), std::fabs(smaller));
}

std::optional<Normal> fit_normal(const Neighbourhood& sums, double noise_m) {
  if (sums.count < kFewestPoints) return std::nullopt;
  const auto n = static_cast<double>(sums.count);
  const double xx = sums.xx - sums.x * sums.x / n;
  const double xy = sums.xy - sums.x * sums.y / n;
  const double yy = sums.yy - sums.y * sums.y / n;
  const double spread = std::sqrt((xx - yy) * (xx - yy) + 4.0 * xy * xy);
  const double along = 0.5 * (xx + yy + spread);
  const double across = 0.5 * (xx + yy - spread);
  if (!(spread > 0.0) || across > kFlatness * along + n * square(std::max(kRoughness_m, kRoughnessNoises * noise_m))) {
    return std::nullopt;
  }
  return Normal{across_axis((xx - yy) / spread, 2.0 * xy / spread), across / ((n - 2.0) * along)};
}

// The noise of the returns across their surfaces: median distance of the middle one of three neighbours from the line
// through the others. Corners and edges are fewer than half.
double estimate_noise(std::span<const Point2> points) {
  std::vector<double> off;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Point2 before = points[i] - points[i - 1];
    const Point2 after = points[i + 1] - points[i];
    const double chord_m = (before + after).norm();
    if (chord_m > kMostReach_m || chord_m <= 0.0) continue;
    const double share = before.dot(before + after) / square(chord_m);
    const double gain = std::sqrt(1.0 + square(share) + square(1.0 - share));
    off.push_back(std::fabs(before.x() * after.y() - before.y() * after.x()) / (chord_m * gain));
  }
  if (off.size() < kFewestOfNoise) return 0.0;
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return *middle / kMedianOfNormal;
}

// True if the middle one of three lies farther from the line through the others than its noise.
bool is_off_line(const Point2& a, const Point2& p, const Point2& b, double noise_m) {
  const Point2 before = p - a;
  const Point2 after = b - p;
  const double chord_m = (before + after).norm();
  if (chord_m <= 0.0) return true;
  const double share = before.dot(before + after) / square(chord_m);
  const double gain = std::sqrt(1.0 + square(share) + square(1.0 - share));  // gain of the three points' noise
  const double off_m = std::fabs(before.x() * after.y() - before.y() * after.x()) / chord_m;
  return off_m > std::max(kOffLine_m, kOffLineNoises * noise_m) * gain;
}

// True if no two neighbours are on a line with it.
bool is_corner(std::span<const Point2> points, std::size_t i, double noise_m) {
  if (i < 2 || i + 2 >= points.size()) return false;
  return is_off_line(points[i - 1], points[i], points[i + 1], noise_m) &&
         is_off_line(points[i - 2], points[i - 1], points[i], noise_m) &&
         is_off_line(points[i], points[i + 1], points[i + 2], noise_m);
}

// The information of points, each of which is known within `place_m` in both directions.
Matrix3 lone_point_information(const std::vector<LonePoint>& points, double place_m) {
  if (points.empty()) return {};
  Matrix3 sum;
  for (const LonePoint& p : points) {
    sum += outer(Tangent2{1.0, 0.0, -static_cast<double>(p.y_m)}, Tangent2{1.0, 0.0, -static_cast<double>(p.y_m)});
    sum += outer(Tangent2{0.0, 1.0, static_cast<double>(p.x_m)}, Tangent2{0.0, 1.0, static_cast<double>(p.x_m)});
  }
  const double share = std::min(1.0, kMostLone / static_cast<double>(points.size()));
  return share / square(place_m) * sum;
}

constexpr double kWidestGap_m = 2.0;
constexpr double kNeighbours = 1.5;  // usual angles between beams; a larger one has a missing return
constexpr double kLineNoise_m = 0.02;
constexpr double kLineShare = 0.05;  // distance from the line as a share of the distance to the next point

constexpr double kLone_m = 0.5;

double length(double x, double y) { return std::sqrt(x * x + y * y); }

// Sine of the angle between the beams of two returns.
double sine_between(const Point2& a, const Point2& b) {
  const double product = length(a.x(), a.y()) * length(b.x(), b.y());
  return product > 0.0 ? std::fabs(a.x() * b.y() - a.y() * b.x()) / product : 1.0;
}

double usual_sine(std::span<const Point2> points) {
  std::vector<double> sines;
  for (std::size_t i = 1; i < points.size(); ++i) sines.push_back(sine_between(points[i - 1], points[i]));
  const auto middle = sines.begin() + static_cast<std::ptrdiff_t>(sines.size() / 2);
  std::nth_element(sines.begin(), middle, sines.end());
  return *middle;
}

bool are_neighbours(std::span<const Point2> points, double usual_sine) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (sine_between(points[i - 1], points[i]) > kNeighbours * usual_sine) return false;
  }
  return true;
}

// True if the first and the last of four points lie on the line through the others, none far from the next.
bool are_on_a_line(std::span<const Point2> points) {
  const Point2 gap = points[2] - points[1];
  const double gap_m = length(gap.x(), gap.y());
  if (!(gap_m > 0.0) || gap_m > kWidestGap_m) return false;
  const auto is_on_line = [&](const Point2& point, const Point2& next) {
    const Point2 off = point - next;
    const double away_m = length(off.x(), off.y());
    const double beside_m = std::fabs(off.x() * gap.y() - off.y() * gap.x()) / gap_m;
    return away_m <= kWidestGap_m && beside_m <= std::max(kLineNoise_m, kLineShare * away_m);
  };
  return is_on_line(points[0], points[1]) && is_on_line(points[3], points[2]);
}

}  // namespace

std::vector<Point2> to_points(const KeptScan& scan) {
  std::vector<Point2> points;
  points.reserve(scan.points());
  for (const SurfacePoint& p : scan.surface) points.push_back(p.point());
  for (const LonePoint& p : scan.lone) points.push_back(p.point());
  return points;
}

KeptScan keep_scan(std::span<const Point2> points_base_m) {
  KeptScan kept;
  const double noise_m = estimate_noise(points_base_m);
  double variances = 0.0;
  for (std::size_t i = 0; i < points_base_m.size(); ++i) {
    const Point2& point = points_base_m[i];
    const auto x = static_cast<float>(point.x());
    const auto y = static_cast<float>(point.y());
    const std::optional<Normal> found = fit_normal(sum_neighbours(points_base_m, i, noise_m), noise_m);
    if (!found) {
      kept.lone.push_back({x, y});
      if (is_corner(points_base_m, i, noise_m)) kept.corners.push_back({x, y});
      continue;
    }
    const Point2& normal = found->axis;
    variances += found->variance;
    const double away = normal.x() * point.x() + normal.y() * point.y();
    const double sign = away > 0.0 ? -1.0 : 1.0;
    kept.surface.push_back({x, y, static_cast<float>(sign * normal.x()), static_cast<float>(sign * normal.y()),
                            static_cast<float>(pseudo_bearing(point.x(), point.y()))});
  }
  if (!kept.surface.empty()) kept.normal_variance = variances / static_cast<double>(kept.surface.size());
  std::stable_sort(kept.surface.begin(), kept.surface.end(),
                   [](const SurfacePoint& a, const SurfacePoint& b) { return a.direction < b.direction; });
  return kept;
}

Matrix3 surface_shape(const KeptScan& scan) {
  Matrix3 shape;
  for (const SurfacePoint& p : scan.surface) {
    const double nx = p.normal_x;
    const double ny = p.normal_y;
    const double lever = static_cast<double>(p.x_m) * ny - static_cast<double>(p.y_m) * nx;
    const Tangent2 J{nx, ny, lever};
    shape += outer(J, J);
  }
  return shape;
}

Matrix3 lone_information(const KeptScan& scan) {
  const double missing = 1.0 - static_cast<double>(scan.surface.size()) / kSurfaceEnough;
  if (missing <= 0.0) return lone_point_information(scan.corners, kCornerPlace_m);
  return missing * lone_point_information(scan.lone, kLonePlace_m);
}

bool knows_way(const KeptScan& scan, const Point2& direction) {
  const double length_squared = direction.squaredNorm();
  std::size_t across = 0;
  for (const SurfacePoint& p : scan.surface) {
    const double along = p.normal().dot(direction);
    across += along * along >= kAcross * length_squared ? 1U : 0U;
  }
  return static_cast<double>(across) > kEnoughAcross * static_cast<double>(scan.surface.size());
}

// The translation is scaled along its own axes, from both sides, so that the matrix stays positive and keeps the
// information about the heading.
ShapeOfOne shape_of_one(const Matrix3& shape, std::size_t points, double least, double noise) {
  const double share = points > 0 ? 1.0 / static_cast<double>(points) : 0.0;
  const Matrix3 one = share * shape;
  const Eigen3 eigen = eigen_of_symmetric({{one(0, 0), one(0, 1), 0.0, one(0, 1), one(1, 1), 0.0, 0.0, 0.0, 1.0}});
  ShapeOfOne result;
  Matrix3 scale;
  for (std::size_t k = 0; k < 3; ++k) {
    const int column = static_cast<int>(k);
    const Tangent2 axis{eigen.vectors(0, column), eigen.vectors(1, column), eigen.vectors(2, column)};
    const bool is_heading = axis[2] * axis[2] > 0.5;
    const double value = eigen.values[k];
    const double believed = is_heading ? 1.0 : std::max(0.0, value - noise) / std::max(value, kTiniest);
    scale += std::sqrt(believed) * outer(axis, axis);
    result.believed += believed * outer(axis, axis);
  }
  result.shape = scale * one * scale + Matrix3::diagonal(least, least, least);
  return result;
}

void put_on(ByteShelf& shelf, const KeptScan& scan) {
  const std::array<std::uint32_t, 2> counts{static_cast<std::uint32_t>(scan.surface.size()),
                                            static_cast<std::uint32_t>(scan.lone.size())};
  shelf.put({value_bytes(counts), std::as_bytes(std::span(scan.surface)), std::as_bytes(std::span(scan.lone))});
}

void take_from(std::span<const std::byte> record, KeptScan& scan) {
  std::array<std::uint32_t, 2> counts{};
  take_values(record, std::span<std::uint32_t>(counts));
  scan.surface.resize(counts[0]);
  scan.lone.resize(counts[1]);
  take_values(record, std::span(scan.surface));
  take_values(record, std::span(scan.lone));
}

std::vector<Point2> with_surfaces_closed(std::span<const Point2> points_base_m, double spacing_m) {
  constexpr std::size_t kInARow = 4;
  std::vector<Point2> closed(points_base_m.begin(), points_base_m.end());
  if (points_base_m.size() < kInARow) return closed;
  const double sine = usual_sine(points_base_m);
  for (std::size_t i = 0; i + kInARow <= points_base_m.size(); ++i) {
    const std::span<const Point2> row = points_base_m.subspan(i, kInARow);
    if (!are_neighbours(row, sine) || !are_on_a_line(row)) continue;
    const Point2 gap = row[2] - row[1];
    const auto pieces = static_cast<int>(length(gap.x(), gap.y()) / spacing_m) + 1;
    for (int k = 1; k < pieces; ++k) closed.push_back(row[1] + static_cast<double>(k) / pieces * gap);
  }
  return closed;
}

std::optional<Point2> lone_on_wall(std::span<const Point2> points_base_m, std::size_t at) {
  const std::size_t count = points_base_m.size();
  const auto is_near = [&](std::size_t other) { return (points_base_m[at] - points_base_m[other]).norm() < kLone_m; };
  if ((at > 0 && is_near(at - 1)) || (at + 1 < count && is_near(at + 1))) return std::nullopt;
  for (const std::size_t before : {1U, 2U, 0U}) {  // offsets of a triple: the three neighbours before this point
    if (at < before || at - before + 2 >= count) continue;
    const Point2& first = points_base_m[at - before];
    const Point2 chord = points_base_m[at - before + 2] - first;
    const Point2 middle = points_base_m[at - before + 1] - first;
    const double far_m = std::max(middle.norm(), (chord - middle).norm());
    const double aside_m = std::fabs(middle.x() * chord.y() - middle.y() * chord.x()) / chord.norm();
    if (aside_m < std::max(kLineNoise_m, kLineShare * far_m)) return chord / chord.norm();
  }
  return std::nullopt;
}

}  // namespace gdtslam
