#include "pose_certainty.hpp"

#include <algorithm>
#include <cstddef>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/core/elementary.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostWeighed = 1024;        // points
constexpr std::int32_t kAside = 2;                // cells from a wall, where its field has a constant gradient
constexpr double kLeastGradient = 0.3;            // squared, of four: a smaller value is the inside of a thick object
constexpr double kLeastInformation = 0.01;        // a scan determines the robot's position at least within ten metres
constexpr double kRoundingVariance = 1.0 / 12.0;  // variance of a position known to a cell, cells squared

/// n n^T of a wall's normal, mixed where walls meet; trace 1.
struct NormalTensor {
  double xx = 0.0, xy = 0.0, yy = 0.0;
};

// The distance has a kink on the wall itself; its gradient on both sides is the same up to the sign.
std::optional<NormalTensor> normal_at(const GlobalField& map, CellIndex cell) {
  NormalTensor sum;
  for (const CellOffset aside : {CellOffset{-kAside, -kAside}, CellOffset{kAside, -kAside}, CellOffset{-kAside, kAside},
                                 CellOffset{kAside, kAside}}) {
    const CellIndex at = cell + aside;
    const auto value = [&map, &at](std::int32_t dx, std::int32_t dy) {
      return static_cast<double>(map.at({at.x + dx, at.y + dy}));
    };
    const double gx = (value(1, 0) - value(-1, 0)) / (2.0 * kFieldOne);
    const double gy = (value(0, 1) - value(0, -1)) / (2.0 * kFieldOne);
    sum.xx += gx * gx;
    sum.xy += gx * gy;
    sum.yy += gy * gy;
  }
  const double trace = sum.xx + sum.yy;
  if (!(trace > kLeastGradient)) return std::nullopt;
  return NormalTensor{sum.xx / trace, sum.xy / trace, sum.yy / trace};
}

/// Sums over points; the information is for a variance of one.
struct PointSums {
  Matrix3 information;
  double sq_distance = 0.0;  // cells
  double sq_range = 0.0;     // metres
  double count = 0.0;

  void add(const PointSums& other, double weight) {
    information += weight * other.information;
    sq_distance += weight * other.sq_distance;
    sq_range += weight * other.sq_range;
    count += weight * other.count;
  }
};

/// Consecutive points in the same cell count as one.
class CellSums {
 public:
  void add(CellIndex cell, const PointSums& point) {
    if (!(cell == cell_)) close();
    cell_ = cell;
    one_.add(point, 1.0);
  }
  [[nodiscard]] const PointSums& closed() {
    close();
    return all_;
  }

 private:
  void close() {
    if (one_.count > 0.0) all_.add(one_, 1.0 / one_.count);
    one_ = {};
  }
  PointSums all_;
  PointSums one_;
  CellIndex cell_{};
};

// J^T N J, the normals turned into the robot's frame.
Matrix3 point_information(const NormalTensor& n, const SinCos<double>& turn, double x, double y) {
  const double c = turn.cos;
  const double s = turn.sin;
  const double xx = c * c * n.xx + 2.0 * c * s * n.xy + s * s * n.yy;
  const double yy = s * s * n.xx - 2.0 * c * s * n.xy + c * c * n.yy;
  const double xy = c * s * (n.yy - n.xx) + (c * c - s * s) * n.xy;
  const double xt = xy * x - xx * y;
  const double yt = yy * x - xy * y;
  return {{xx, xy, xt, xy, yy, yt, xt, yt, yt * x - xt * y}};
}

double compute_determinant(const Matrix3& a) {
  const Matrix3 l = cholesky(a);
  return square(l(0, 0) * l(1, 1) * l(2, 2));
}

}  // namespace

std::optional<Matrix3> covariance_by_scan(const GlobalField& map, std::span<const PointCells> points,
                                          const Pose2& T_map_base, double gate_m) {
  const double r = map.geometry().resolution_m;
  const double gate = gate_m / r;
  const SinCos<double> turn = sin_cos(T_map_base.theta_rad);
  const std::size_t every = std::max<std::size_t>(1, (points.size() + kMostWeighed - 1) / kMostWeighed);
  CellSums cells;
  for (std::size_t i = 0; i < points.size(); i += every) {
    const double x = r * static_cast<double>(points[i].x);
    const double y = r * static_cast<double>(points[i].y);
    const CellIndex cell =
        map_cell_at({turn.cos * x - turn.sin * y + T_map_base.x_m, turn.sin * x + turn.cos * y + T_map_base.y_m}, r);
    const double distance = static_cast<double>(map.at(cell)) / kFieldOne;
    if (distance > gate) continue;
    const std::optional<NormalTensor> normal = normal_at(map, cell);
    if (normal) cells.add(cell, {point_information(*normal, turn, x, y), distance * distance, x * x + y * y, 1.0});
  }
  const PointSums& sum = cells.closed();
  if (!(sum.count > 0.0)) return std::nullopt;
  const double rounding = kRoundingVariance * r * r;
  const double variance = r * r * sum.sq_distance / sum.count + rounding;
  const double sq_lever = std::max(sum.sq_range / sum.count, r * r);
  const Matrix3 least = Matrix3::diagonal(kLeastInformation, kLeastInformation, kLeastInformation);
  return inverse((1.0 / variance) * sum.information + least) +
         Matrix3::diagonal(rounding, rounding, rounding / sq_lever);
}

Matrix3 intersect_covariances(const Matrix3& a, const Matrix3& b) {
  constexpr int kSteps = 8;
  const Matrix3 by_a = inverse(a);
  const Matrix3 by_b = inverse(b);
  Matrix3 best = by_a;
  double most = compute_determinant(best);
  for (int k = 0; k < kSteps; ++k) {
    const double share = static_cast<double>(k) / kSteps;
    const Matrix3 both = share * by_a + (1.0 - share) * by_b;
    const double determinant = compute_determinant(both);
    if (!(determinant > most)) continue;
    most = determinant;
    best = both;
  }
  return inverse(best);
}

// The smallest covariance that can be inverted safely.
PoseCertainty::PoseCertainty() {
  constexpr double kSigma = 0.001;  // metres and radians
  covariance_ = Matrix3::diagonal(square(kSigma), square(kSigma), square(kSigma));
}

void PoseCertainty::carry(const Pose2& T_map_last, const Prediction& prediction, const MotionNoise& wheels) {
  const MotionNoise noise =
      prediction.by_odometry ? wheels : MotionNoise{prediction.travelled_m, prediction.turned_rad};
  const Matrix3 moved = adjoint_matrix(between(prediction.T_map_base, T_map_last));
  const double m = square(noise.sigma_m);
  covariance_ = moved * times_transposed(covariance_, moved) + Matrix3::diagonal(m, m, square(noise.sigma_rad));
}

void PoseCertainty::weigh(const GlobalField& map, std::span<const PointCells> points, const Pose2& T_map_base,
                          double gate_m) {
  const std::optional<Matrix3> by_scan = covariance_by_scan(map, points, T_map_base, gate_m);
  if (by_scan) covariance_ = intersect_covariances(*by_scan, covariance_);
}

PoseCovariance PoseCertainty::in_map(double theta_rad) const {
  const auto [sin, cos] = sin_cos(theta_rad);
  const Matrix3 turn{{cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0}};
  const Matrix3 c = turn * times_transposed(covariance_, turn);
  return {.xx = c(0, 0), .xy = c(0, 1), .xt = c(0, 2), .yy = c(1, 1), .yt = c(1, 2), .tt = c(2, 2)};
}

}  // namespace gdtslam
