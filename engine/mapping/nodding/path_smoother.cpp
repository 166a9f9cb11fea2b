#include "path_smoother.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/mapping/graph/block_cholesky.hpp"
#include "engine/mapping/graph/matrix3.hpp"

namespace gdtslam {
namespace {

/// Distance to the map and its gradient at any point of the map frame, metres: bilinear between the centres of the
/// cells; a view, valid until the field changes.
class FieldGradient {
 public:
  explicit FieldGradient(const GlobalField& field)
      : field_(&field),
        geometry_(field.geometry()),
        cap_(field.cap()),
        unit_m_(field.geometry().resolution_m / 256.0) {}

  struct Value {
    double distance_m = 0.0;
    Point2 gradient{0.0, 0.0};
  };
  /// Value of the field at a point; empty if the map knows nothing nearby.
  [[nodiscard]] std::optional<Value> at(const Point2& point) const {
    const double x = (point.x() - geometry_.origin_x_m) / geometry_.resolution_m - 0.5;
    const double y = (point.y() - geometry_.origin_y_m) / geometry_.resolution_m - 0.5;
    if (!(x >= 0.0 && y >= 0.0 && x < geometry_.width - 1 && y < geometry_.height - 1)) return std::nullopt;
    const auto column = static_cast<std::int32_t>(x);
    const auto row = static_cast<std::int32_t>(y);
    const std::array<std::uint16_t, 4> raw = field_->at_and_beside(field_->box().min + CellOffset{column, row});
    for (const std::uint16_t value : raw) {
      if (value >= cap_) return std::nullopt;
    }
    const double fx = x - column;
    const double fy = y - row;
    const double low = raw[0] + fx * (raw[1] - raw[0]);
    const double high = raw[2] + fx * (raw[3] - raw[2]);
    const double right = raw[1] + fy * (raw[3] - raw[1]);
    const double left = raw[0] + fy * (raw[2] - raw[0]);
    const double slope = unit_m_ / geometry_.resolution_m;
    return Value{unit_m_ * (low + fy * (high - low)), {slope * (right - left), slope * (high - low)}};
  }

 private:
  const GlobalField* field_;
  GridGeometry geometry_;
  std::uint16_t cap_;
  double unit_m_;
};

constexpr double kFirstGate_m = 0.45;  // the field is capped at R, half a metre
constexpr double kGateShrinks = 0.6;
constexpr double kLeastVariance = 1.0e-8;
constexpr std::size_t kMostStations = 400;

/// An estimated pose: a node of the path with the points of its scan.
struct Station {
  std::size_t node = 0;
  PoseFix placed;  ///< pose before the smoothing
  Pose2 T_map_base;
  std::vector<Point2> points;
};

/// One step of the odometry: its motion and its information.
struct Link {
  Pose2 motion;
  Matrix3 information;
};

Link make_link(const SmootherConfig& config, const PoseFix& from, const PoseFix& to) {
  const Pose2 T_placed = between(from.T_map_base, to.T_map_base);
  const Pose2 motion = between(from.T_odom_base, to.T_odom_base);
  const double way_m = std::sqrt(motion.x_m * motion.x_m + motion.y_m * motion.y_m);
  const double turn_rad = std::fabs(motion.theta_rad);
  const double along = config.odometry_m_per_sqrt_m * config.odometry_m_per_sqrt_m * way_m + kLeastVariance;
  const double about = square(config.odometry_rad_per_sqrt_rad) * (kTurnsPerMetre * way_m + turn_rad) + kLeastVariance;
  return {T_placed, Matrix3::diagonal(1.0 / along, 1.0 / along, 1.0 / about)};
}

// Adds the odometry's equations of two neighbours. A fix has no row, because it does not move.
void add_link(const Link& link, const Pose2& from, const Pose2& to, std::optional<std::size_t> row_from,
              std::optional<std::size_t> row_to, BlockSystem& chain) {
  const Pose2 actual = between(from, to);
  const Matrix3 by_from = -1.0 * adjoint_matrix(inverse(actual));
  const Tangent2 pull = link.information * log_tangent(between(link.motion, actual));
  if (row_from) {
    chain.diagonal[*row_from] += transposed_times(by_from, link.information * by_from);
    subtract(chain.right[*row_from], transposed(by_from) * pull);
  }
  if (row_to) {
    chain.diagonal[*row_to] += link.information;
    subtract(chain.right[*row_to], pull);
  }
  if (row_from && row_to) chain.add(*row_to, *row_from, link.information * by_from);
}

// Normal equations of the points' distances to the map, linearised about this pose by the gradient.
PointsView points_view(const SmootherConfig& config, const FieldGradient& field, double gate_m, const Pose2& T_map_base,
                       std::span<const Point2> points) {
  PointsView view;
  double count = 0.0;
  const auto turn = sin_cos(T_map_base.theta_rad);
  for (const Point2& p : points) {
    const Point2 q(turn.cos * p.x() - turn.sin * p.y() + T_map_base.x_m,
                   turn.sin * p.x() + turn.cos * p.y() + T_map_base.y_m);
    const std::optional<FieldGradient::Value> value = field.at(q);
    if (!value || value->distance_m > gate_m) continue;
    const Point2 g(turn.cos * value->gradient.x() + turn.sin * value->gradient.y(),
                   -turn.sin * value->gradient.x() + turn.cos * value->gradient.y());  // robot frame
    const Tangent2 J{g.x(), g.y(), g.y() * p.x() - g.x() * p.y()};
    const double share = value->distance_m / gate_m;
    const double weight = (1.0 - share * share) * (1.0 - share * share);  // Tukey's
    view.information += weight * outer(J, J);
    for (std::size_t k = 0; k < 3; ++k) view.away[k] += weight * value->distance_m * J[k];
    count += weight;
  }
  if (!(count > 0.0)) return {};
  const double scale = std::min(1.0, config.independent_points / count) / square(config.point_sigma_m);
  view.information = scale * view.information;
  for (double& value : view.away) value *= scale;
  return view;
}

// Student's t weight of a whole scan [Lange1989], because objects in front of the walls at other heights suggest a
// motion that no odometry explains. A direction that no surface constrains does not count.
double trust_in(const PointsView& view) {
  const Matrix3 covariance = with_eigenvalues(eigen_of_symmetric(view.information), [](double information) {
    return information > kLeastViewInformation ? 1.0 / information : 0.0;
  });
  return student_weight(squared_norm(covariance, view.away));
}

BlockSystem make_chain_system(std::size_t stations) {
  std::vector<BlockSystem::Pair> neighbours;
  for (std::size_t k = 1; k < stations; ++k) neighbours.emplace_back(k - 1, k);
  return {stations, std::move(neighbours)};
}

std::vector<Point2> thinned(std::vector<Point2> points, std::size_t most) {
  const std::size_t every = std::max<std::size_t>(1, (points.size() + most - 1) / most);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < points.size(); k += every) points[kept++] = points[k];
  points.resize(kept);
  return points;
}

// Odometry distance between two nodes, in station spacings.
double steps_between(const SmootherConfig& config, const PoseFix& a, const PoseFix& b) {
  const Pose2 step = between(a.T_odom_base, b.T_odom_base);
  return std::max(translation_length(step) / config.spacing_m, std::fabs(step.theta_rad) / config.spacing_rad);
}

// Position of each node along the way from one pose to another, 0 to 1.
std::vector<double> shares_of_way(const SmootherConfig& config, const PoseFix& from, const PoseFix& to,
                                  std::span<const PoseFix> nodes) {
  std::vector<double> shares;
  shares.reserve(nodes.size());
  double sum = 0.0;
  const PoseFix* last = &from;
  for (const PoseFix& node : nodes) {
    sum += steps_between(config, *last, node);
    shares.push_back(sum);
    last = &node;
  }
  sum += steps_between(config, *last, to);
  for (double& share : shares) share = sum > 0.0 ? share / sum : 1.0;
  return shares;
}

// Selects nodes that are far enough apart by odometry. The spacing grows if there would be more than kMostStations.
std::vector<Station> make_stations(const SmootherConfig& config, const PoseFix& from, const std::vector<PoseFix>& nodes,
                                   const PointsOfNode& node_points) {
  double way = 0.0;
  const PoseFix* last = &from;
  for (const PoseFix& node : nodes) {
    way += steps_between(config, *last, node);
    last = &node;
  }
  const double spacing = std::max(1.0, way / static_cast<double>(kMostStations));
  std::vector<Station> stations;
  way = 0.0;
  last = &from;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    way += steps_between(config, *last, nodes[k]);
    last = &nodes[k];
    if (way < spacing) continue;
    way = 0.0;
    stations.push_back(
        {k, nodes[k], nodes[k].T_map_base, thinned(node_points(k), static_cast<std::size_t>(config.max_points))});
  }
  return stations;
}

void add_equations(const SmootherConfig& config, const FieldGradient& field, double gate_m, const PoseFix& from,
                   const PoseFix& to, const std::vector<Station>& stations, BlockSystem& chain) {
  for (std::size_t k = 0; k <= stations.size(); ++k) {
    const bool is_first = k == 0;
    const bool is_last = k == stations.size();
    const Pose2& a = is_first ? from.T_map_base : stations[k - 1].T_map_base;
    const Pose2& b = is_last ? to.T_map_base : stations[k].T_map_base;
    const Link link = make_link(config, is_first ? from : stations[k - 1].placed, is_last ? to : stations[k].placed);
    add_link(link, a, b, is_first ? std::nullopt : std::optional(k - 1), is_last ? std::nullopt : std::optional(k),
             chain);
    if (is_last) continue;
    const PointsView view = points_view(config, field, gate_m, stations[k].T_map_base, stations[k].points);
    const double trust = trust_in(view);
    chain.diagonal[k] += trust * view.information;
    subtract(chain.right[k], {trust * view.away[0], trust * view.away[1], trust * view.away[2]});
  }
}

// Places the nodes between two stations on the circle through both, each at its share of the odometry's way. Over such
// a short distance the circle is smoother than the odometry.
void place_nodes(const SmootherConfig& config, const PoseFix& from, const PoseFix& to,
                 const std::vector<Station>& stations, std::vector<PoseFix>& nodes) {
  PoseFix last = from;
  std::size_t begin = 0;
  const auto place_until = [&](std::size_t end, const PoseFix& next) {
    const std::span<PoseFix> between_them = std::span(nodes).subspan(begin, end - begin);
    const std::vector<double> shares = shares_of_way(config, last, next, between_them);
    for (std::size_t k = 0; k < between_them.size(); ++k) {
      between_them[k].T_map_base = interpolate(PoseInterpolation::kGeodesic, last, next, shares[k], {});
    }
    last = next;
  };
  for (const Station& station : stations) {
    nodes[station.node].T_map_base = station.T_map_base;
    place_until(station.node, nodes[station.node]);
    begin = station.node + 1;
  }
  place_until(nodes.size(), to);
}

}  // namespace

PointsView view_from(const SmootherConfig& config, const GlobalField& field, const Pose2& T_map_base,
                     const std::vector<Point2>& points) {
  const std::vector<Point2> few = thinned(points, static_cast<std::size_t>(config.max_points));
  return points_view(config, FieldGradient(field), config.gate_m, T_map_base, few);
}

std::size_t smooth_path(const SmootherConfig& config, const GlobalField& field, const PoseFix& from, const PoseFix& to,
                        std::vector<PoseFix>& nodes, const PointsOfNode& node_points) {
  std::vector<Station> stations = make_stations(config, from, nodes, node_points);
  if (stations.empty()) return 0;
  const FieldGradient gradient(field);
  BlockSystem chain = make_chain_system(stations.size());
  BlockCholesky factor(chain);
  double gate_m = kFirstGate_m;
  for (std::int32_t k = 0; k < config.iterations; ++k) {
    chain.clear();
    add_equations(config, gradient, gate_m, from, to, stations, chain);
    if (!factor.factorise(chain)) return 0;
    std::vector<Tangent2> steps = chain.right;
    factor.solve(steps);
    for (std::size_t s = 0; s < stations.size(); ++s) {
      stations[s].T_map_base = stations[s].T_map_base * exp_tangent(steps[s]);
    }
    gate_m = std::max(config.gate_m, kGateShrinks * gate_m);
  }
  place_nodes(config, from, to, stations, nodes);
  return static_cast<std::size_t>(
      std::count_if(stations.begin(), stations.end(), [](const Station& station) { return !station.points.empty(); }));
}

}  // namespace gdtslam
