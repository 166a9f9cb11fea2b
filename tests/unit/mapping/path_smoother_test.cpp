// The path between two fixes: against the true path in a room that is known, and against a cost that is written down
// here on its own.
#include "engine/mapping/nodding/path_smoother.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "engine/mapping/map/local_field.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr double kResolution = 0.025;
constexpr std::uint32_t kRadius = 20;
constexpr MergeStep kStationStep{.rule = MergeRule::kWorking, .threshold = 256, .lift = 128};

/// Axis-parallel walls; the map's frame.
struct Wall {
  Point2 from;
  Point2 to;
};
// Through the centres of cells, so that the map has them where they are.
constexpr double kWest = -1.9875;
constexpr double kEast = 4.0125;
constexpr double kSouth = -1.9875;
constexpr double kNorth = 2.5125;
const std::vector<Wall> kRoom{{{kWest, kSouth}, {kEast, kSouth}},
                              {{kEast, kSouth}, {kEast, kNorth}},
                              {{kEast, kNorth}, {kWest, kNorth}},
                              {{kWest, kNorth}, {kWest, kSouth}}};
const std::vector<Wall> kCorridor{{{-20, -0.9875}, {20, -0.9875}}, {{-20, 1.0125}, {20, 1.0125}}};

/// A map that holds points of the walls, 1 cm apart.
class Map {
 public:
  explicit Map(const std::vector<Wall>& walls) {
    std::vector<Point2> points;
    for (const Wall& wall : walls) {
      const Point2 way = wall.to - wall.from;
      const auto steps = static_cast<int>(way.norm() / 0.01);
      for (int k = 0; k <= steps; ++k) points.push_back(wall.from + way * (static_cast<double>(k) / steps));
    }
    const KeyframeCells keyframe = make_keyframe_cells(points, kResolution, kRadius);
    field_.grow_to_hold(keyframe.window);
    LocalField local(*backend_, kRadius);
    local.prepare(keyframe, field_);
    local.merge_into(field_, kStationStep);
  }
  [[nodiscard]] const GlobalField& field() const { return field_; }

 private:
  std::unique_ptr<Backend> backend_ = make_cpu_backend({});
  GlobalField field_{*backend_, kResolution, kRadius, 1U << 22U};
};

/// What a laser with `beams` beams all round sees from a pose, robot frame: where a ray meets the first wall.
std::vector<Point2> seen_from(const Pose2& T_map_base, const std::vector<Wall>& walls, int beams) {
  std::vector<Point2> points;
  for (int k = 0; k < beams; ++k) {
    const double bearing = 2.0 * 3.14159265358979 * (k + 0.5) / beams;
    const double angle = T_map_base.theta_rad + bearing;
    const Point2 ray(std::cos(angle), std::sin(angle));
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
      const int across = wall.from.x() == wall.to.x() ? 0 : 1;
      const double range = (wall.from[across] - T_map_base.translation()[across]) / ray[across];
      const double along = T_map_base.translation()[1 - across] + range * ray[1 - across];
      const double low = std::min(wall.from[1 - across], wall.to[1 - across]);
      const double high = std::max(wall.from[1 - across], wall.to[1 - across]);
      if (range > 0.0 && along >= low && along <= high) nearest = std::min(nearest, range);
    }
    if (nearest < 15.0) points.emplace_back(nearest * std::cos(bearing), nearest * std::sin(bearing));
  }
  return points;
}

struct Path {
  std::vector<Pose2> truth;  ///< with both ends
  PoseFix from;
  PoseFix to;
  std::vector<PoseFix> nodes;
};

/// `steps` steps of `step` in the odometry, whose true motion is `step` times a disturbance; both ends are known. The
/// first estimate goes with the odometry from the beginning.
Path path_of(const Pose2& start, const Pose2& step, int steps, double scale, double noise_m, double noise_rad) {
  Path path;
  Random random(7);
  Pose2 T_map = start;
  Pose2 T_odom;
  path.truth.push_back(T_map);
  path.from = {0.0, T_map, T_odom};
  for (int k = 1; k <= steps; ++k) {
    T_odom = T_odom * step;
    T_map = T_map * Pose2{scale * step.x_m + noise_m * random.normal(), noise_m * random.normal(),
                          step.theta_rad + noise_rad * random.normal()};
    path.truth.push_back(T_map);
    path.nodes.push_back({0.05 * k, start * T_odom, T_odom});
  }
  path.to = path.nodes.back();
  path.to.T_map_base = T_map;
  path.nodes.pop_back();
  return path;
}

/// As a mapper does it: what is left over is spread first, then the walls correct that.
std::size_t smooth(const Map& map, Path& path, const PointsOfNode& to_points, const SmootherConfig& config = {}) {
  place_between(PoseInterpolation::kOdometry, path.from, path.to, path.nodes);
  return smooth_path(config, map.field(), path.from, path.to, path.nodes, to_points);
}

double mean_error_m(const Path& path) {
  double sum = 0.0;
  for (std::size_t k = 0; k < path.nodes.size(); ++k) {
    sum += (path.nodes[k].T_map_base.translation() - path.truth[k + 1].translation()).norm();
  }
  return sum / static_cast<double>(path.nodes.size());
}

PointsOfNode eyes(const Path& path, const std::vector<Wall>& walls, int beams = 120) {
  return [&path, &walls, beams](std::size_t k) { return seen_from(path.truth[k + 1], walls, beams); };
}
const PointsOfNode kBlind = [](std::size_t) { return std::vector<Point2>{}; };

// Two metres with wheels that read 8 % short and a heading that wanders.
TEST(PathSmoother, WallsShowTheWayWhereTheOdometryIsWrong) {
  const Map map(kRoom);
  Path path = path_of({-0.5, -0.4, 0.1}, {0.02, 0.0, 0.004}, 100, 1.08, 0.004, 0.02);
  const double before_m = mean_error_m(path);
  Path blind = path;
  smooth(map, blind, kBlind);
  const std::size_t helped = smooth(map, path, eyes(path, kRoom));
  EXPECT_GE(helped, 15U);  // a station each decimetre of the two metres
  EXPECT_GT(before_m, 0.06);
  EXPECT_LT(mean_error_m(path), 0.01);
  EXPECT_LT(mean_error_m(path), 0.5 * mean_error_m(blind));
}

// Between two walls without ends nothing tells how far: across the corridor the walls lead, along it the odometry.
TEST(PathSmoother, AlongACorridorTheOdometryIsBelieved) {
  const Map map(kCorridor);
  Path path = path_of({0.0, 0.1, 0.0}, {0.05, 0.0, 0.0}, 60, 1.0, 0.0, 0.0);
  for (std::size_t k = 0; k < path.truth.size(); ++k) {  // it swerves, which the wheels do not see
    path.truth[k].y_m = 0.1 + 0.08 * std::sin(3.14159265358979 * static_cast<double>(k) / 60.0);
    path.truth[k].theta_rad = 0.0;
  }
  Path blind = path;
  smooth(map, blind, kBlind);
  ASSERT_GT(smooth(map, path, eyes(path, kCorridor)), 20U);
  for (std::size_t k = 0; k < path.nodes.size(); ++k) {
    EXPECT_NEAR(path.nodes[k].T_map_base.x_m, blind.nodes[k].T_map_base.x_m, 0.01) << k;
    EXPECT_NEAR(path.nodes[k].T_map_base.y_m, path.truth[k + 1].y_m, 0.02) << k;
    EXPECT_NEAR(blind.nodes[k].T_map_base.y_m, 0.1, 1e-9) << k;
  }
}

// A straight way that is 10 cm longer than the wheels say: every tenth of it takes a tenth of that.
TEST(PathSmoother, WithoutPointsWhatIsLeftOverIsSpreadEvenlyOverTheWay) {
  const Map map(kRoom);
  Path path = path_of({-1.0, 0.0, 0.0}, {0.02, 0.0, 0.0}, 100, 1.05, 0.0, 0.0);
  smooth(map, path, kBlind);
  for (std::size_t k = 0; k < path.nodes.size(); ++k) {
    EXPECT_NEAR(path.nodes[k].T_map_base.x_m, -1.0 + 0.021 * static_cast<double>(k + 1), 1e-6) << k;
    EXPECT_NEAR(path.nodes[k].T_map_base.y_m, 0.0, 1e-9) << k;
  }
}

// Whatever the scans say, the ends stay where they are and their neighbours stay near them.
TEST(PathSmoother, NothingPullsThePathAwayFromItsEnds) {
  const Map map(kRoom);
  Path path = path_of({-0.5, -0.4, 0.1}, {0.02, 0.0, 0.004}, 100, 1.0, 0.0, 0.0);
  const PointsOfNode aside = [&path](std::size_t k) {
    return seen_from(Pose2{0.0, 0.15, 0.0} * path.truth[k + 1], kRoom, 120);
  };
  smooth(map, path, aside);
  const auto gap_m = [](const PoseFix& a, const PoseFix& b) {
    return (a.T_map_base.translation() - b.T_map_base.translation()).norm();
  };
  EXPECT_NEAR(gap_m(path.from, path.nodes.front()), 0.02, 0.02);
  EXPECT_NEAR(gap_m(path.to, path.nodes.back()), 0.02, 0.02);
  EXPECT_NEAR(path.nodes[49].T_map_base.y_m, path.truth[50].y_m + 0.15, 0.06);  // in the middle they lead
}

// Points far from every wall (a person, another floor) are no evidence.
TEST(PathSmoother, PointsFarFromTheMapDoNotCount) {
  const Map map(kRoom);
  Path path = path_of({-0.5, -0.4, 0.1}, {0.02, 0.0, 0.004}, 100, 1.02, 0.001, 0.002);
  Path blind = path;
  const PointsOfNode junk = [](std::size_t) { return std::vector<Point2>(50, Point2{0.3, 0.2}); };
  smooth(map, path, junk);
  smooth(map, blind, kBlind);
  for (std::size_t k = 0; k < path.nodes.size(); ++k) {
    EXPECT_EQ(path.nodes[k].T_map_base.x_m, blind.nodes[k].T_map_base.x_m);
    EXPECT_EQ(path.nodes[k].T_map_base.theta_rad, blind.nodes[k].T_map_base.theta_rad);
  }
}

// A cupboard 35 cm before a wall that the map does not have: near enough to pull at first, not against the walls that
// are seen too.
TEST(PathSmoother, WhatStandsBeforeAWallDoesNotLead) {
  const Map map(kRoom);
  Path path = path_of({-0.5, -0.4, 0.1}, {0.02, 0.0, 0.004}, 100, 1.08, 0.004, 0.02);
  const PointsOfNode with_cupboard = [&path](std::size_t k) {
    std::vector<Point2> points = seen_from(path.truth[k + 1], kRoom, 120);
    for (int i = 0; i < 40; ++i) points.push_back(inverse(path.truth[k + 1]) * Point2(0.025 * i, kSouth + 0.35));
    return points;
  };
  smooth(map, path, with_cupboard);
  EXPECT_LT(mean_error_m(path), 0.01);
}

TEST(PathSmoother, APathThatIsTooShortForAStationStaysAsItIs) {
  const Map map(kRoom);
  Path path = path_of({-0.5, -0.4, 0.1}, {0.01, 0.0, 0.001}, 8, 1.0, 0.0, 0.0);
  place_between(PoseInterpolation::kOdometry, path.from, path.to, path.nodes);
  const std::vector<PoseFix> before = path.nodes;
  EXPECT_EQ(smooth_path({}, map.field(), path.from, path.to, path.nodes, eyes(path, kRoom)), 0U);
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_EQ(path.nodes[k].T_map_base, before[k].T_map_base);
}

/// How many stations a way has whose scans all have a point, far from every wall.
std::size_t stations_of_way(const Map& map, const SmootherConfig& config, const Pose2& step, int nodes) {
  Path path = path_of({}, step, nodes + 1, 1.0, 0.0, 0.0);
  return smooth_path(config, map.field(), path.from, path.to, path.nodes, [](std::size_t) {
    return std::vector<Point2>{{0.3, 0.2}};
  });
}

// Numbers that binary fractions have exactly: a step of just the spacing is enough, one that is the least bit shorter
// is not.
TEST(PathSmoother, AStationStandsAtEverySpacingAndNoNearer) {
  const Map map(kRoom);
  SmootherConfig config;
  config.iterations = 1;
  config.spacing_m = 0.125;
  config.spacing_rad = 0.125;
  EXPECT_EQ(stations_of_way(map, config, {0.125, 0.0, 0.0}, 24), 24U);
  EXPECT_EQ(stations_of_way(map, config, {-0.125, 0.0, 0.0}, 24), 24U);
  EXPECT_EQ(stations_of_way(map, config, {0.0625, 0.0, 0.0}, 24), 12U);
  EXPECT_EQ(stations_of_way(map, config, {0.1249, 0.0, 0.0}, 24), 12U);
  EXPECT_EQ(stations_of_way(map, config, {0.0, 0.0, 0.126}, 24), 24U);
  EXPECT_EQ(stations_of_way(map, config, {0.0, 0.0, -0.126}, 24), 24U);
  EXPECT_EQ(stations_of_way(map, config, {0.0, 0.0, 0.063}, 24), 12U);
  EXPECT_EQ(stations_of_way(map, config, {0.05, 0.0, 0.1}, 24), 12U) << "of the two what asks for more";
}

/// Distance to the map between the centres of its cells, bilinear; metres, negative where it is not known.
double distance_m(const GlobalField& field, const Point2& point) {
  const double x = point.x() / kResolution - 0.5;
  const double y = point.y() / kResolution - 0.5;
  const auto column = static_cast<std::int32_t>(std::floor(x));
  const auto row = static_cast<std::int32_t>(std::floor(y));
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    const std::uint16_t value = field.at({column + k % 2, row + k / 2});
    if (value >= field.cap()) return -1.0;
    sum += value * (k % 2 == 1 ? x - column : 1.0 - (x - column)) * (k / 2 == 1 ? y - row : 1.0 - (y - row));
  }
  return sum * kResolution / 256.0;
}

/// Half the weighted squares of the residuals of the steps as they were placed, and Tukey's loss of the points'
/// distances, 7/4 times: what Student's t weighs where a scan as a whole is hardly off.
double cost_of(const SmootherConfig& config, const GlobalField& field, const Path& path,
               const std::vector<Pose2>& poses, const std::vector<std::vector<Point2>>& points) {
  double cost = 0.0;
  for (std::size_t k = 0; k <= poses.size(); ++k) {
    const Pose2& a = k == 0 ? path.from.T_map_base : poses[k - 1];
    const Pose2& b = k == poses.size() ? path.to.T_map_base : poses[k];
    const PoseFix& placed_a = k == 0 ? path.from : path.nodes[k - 1];
    const PoseFix& placed_b = k == poses.size() ? path.to : path.nodes[k];
    const Pose2 motion = between(placed_a.T_odom_base, placed_b.T_odom_base);
    const Eigen::Vector3d off = log_se2(between(between(placed_a.T_map_base, placed_b.T_map_base), between(a, b)));
    const double way = motion.translation().norm();
    const double variance_m = 0.02 * 0.02 * way + 1e-8;
    const double variance_rad = 0.05 * 0.05 * (0.36 * way + std::fabs(motion.theta_rad)) + 1e-8;
    cost += 0.5 * ((off.x() * off.x() + off.y() * off.y()) / variance_m + off.z() * off.z() / variance_rad);
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (const Point2& point : points[k]) {
      const double distance = distance_m(field, poses[k] * point);
      const double share = distance < 0.0 ? 1.0 : std::min(1.0, distance / config.gate_m);
      const double loss = 1.0 - std::pow(1.0 - share * share, 3.0);
      cost += 1.75 * config.gate_m * config.gate_m / 6.0 * loss / (config.point_sigma_m * config.point_sigma_m);
    }
  }
  return cost;
}

// Every node is a station, and so few points that their number is not capped: where the iteration ends, the cost's
// slope, by differences, is a thousandth of what it is a millimetre beside.
TEST(PathSmoother, EndsWhereTheCostIsLevel) {
  const Map map(kRoom);
  Path path = path_of({-0.6, -0.5, 0.2}, {0.12, 0.0, 0.03}, 12, 1.01, 0.001, 0.003);
  std::vector<std::vector<Point2>> points;
  for (std::size_t k = 0; k < path.nodes.size(); ++k) points.push_back(seen_from(path.truth[k + 1], kRoom, 30));
  SmootherConfig config;
  config.iterations = 60;
  place_between(PoseInterpolation::kOdometry, path.from, path.to, path.nodes);
  const Path placed = path;
  smooth_path(config, map.field(), path.from, path.to, path.nodes, [&points](std::size_t k) { return points[k]; });
  std::vector<Pose2> poses;
  for (const PoseFix& node : path.nodes) poses.push_back(node.T_map_base);
  const auto slope = [&](std::size_t k, const Eigen::Vector3d& along, double at) {
    constexpr double kStep_m = 1e-6;
    std::vector<Pose2> moved = poses;
    moved[k] = poses[k] * exp_se2((at + kStep_m) * along);
    const double high = cost_of(config, map.field(), placed, moved, points);
    moved[k] = poses[k] * exp_se2((at - kStep_m) * along);
    return (high - cost_of(config, map.field(), placed, moved, points)) / (2.0 * kStep_m);
  };
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
      const double beside = std::fabs(slope(k, along, 1e-3));
      EXPECT_LT(std::fabs(slope(k, along, 0.0)), 0.03 * beside) << "node " << k << " axis " << axis;
    }
  }
}

}  // namespace
}  // namespace gdtslam
