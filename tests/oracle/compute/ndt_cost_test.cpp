// Scores of poses in normal distributions, compared with their definition in double and with theory: points at the
// means, and points drawn from the distributions. Tables that are refused.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "support/instruction_sets.hpp"

namespace gdtslam::test {
namespace {

using Table = std::array<std::uint32_t, NdtCost::kSteps>;

/// exp(-q / 6) in thousandths, in eight steps a unit of q.
Table usual_table() {
  Table table{};
  for (std::size_t i = 0; i + 1 < table.size(); ++i) {
    table[i] = static_cast<std::uint32_t>(std::lround(1000.0 * std::exp(-(static_cast<double>(i) + 0.5) / 48.0)));
  }
  return table;
}

/// A box of 6 x 5 x 4 cubes of 2 m with a distribution in each; its corner is far away.
struct NdtWorld {
  NdtCost::Params params{.size_x = 6,
                         .size_y = 5,
                         .size_z = 4,
                         .distribution_count = 120,
                         .origin_x_m = 400.0F,
                         .origin_y_m = -300.0F,
                         .origin_z_m = 20.0F,
                         .cubes_per_m = 0.5F};
  Eigen::Vector3d origin_m{400.0, -300.0, 20.0};
  std::vector<Eigen::Vector3d> means_m;  ///< from the origin
  std::vector<Eigen::Matrix3d> roots;    ///< the information is root^T root
  std::vector<std::uint32_t> map;

  explicit NdtWorld(Random& random) {
    std::vector<NdtCost::Distribution> normals;
    std::vector<std::int32_t> cubes(120);
    for (int i = 0; i < 120; ++i) {
      const Eigen::Vector3d lower(i % 6, i / 6 % 5, i / 30);
      const auto inner = [&] { return random.uniform(0.8, 1.2); };
      means_m.emplace_back(2.0 * lower + Eigen::Vector3d(inner(), inner(), inner()));
      roots.emplace_back(Eigen::Matrix3d::NullaryExpr([&] { return random.uniform(-2.0, 2.0); }) +
                         7.0 * Eigen::Matrix3d::Identity());
      normals.push_back(packed(means_m.back(), roots.back().transpose() * roots.back()));
      cubes[static_cast<std::size_t>(i)] = i;
    }
    map = make_ndt_map(usual_table(), normals, cubes);
  }
  static NdtCost::Distribution packed(const Eigen::Vector3d& mean_m, const Eigen::Matrix3d& information) {
    const Eigen::Vector3f m = mean_m.cast<float>();
    const Eigen::Matrix3f w = information.cast<float>();
    return {m.x(), m.y(), m.z(), w(0, 0), w(0, 1), w(0, 2), w(1, 1), w(1, 2), w(2, 2)};
  }
  [[nodiscard]] std::vector<std::uint32_t> scores(Isa isa, const std::vector<NdtCost::Point>& points,
                                                  const std::vector<NdtCost::Pose>& poses) const {
    NdtCost::Params counted = params;
    counted.point_count = static_cast<std::uint32_t>(points.size());
    std::vector<std::uint32_t> found(poses.size(), 7);
    ndt_cost_host(isa, counted, map, points, poses, found);
    return found;
  }
  /// Bounds of the score by definition: a point that is nearly in another step or cube may count with either.
  [[nodiscard]] std::pair<double, double> range(const std::vector<NdtCost::Point>& points,
                                                const Eigen::Isometry3d& T) const;
};

std::pair<double, double> NdtWorld::range(const std::vector<NdtCost::Point>& points, const Eigen::Isometry3d& T) const {
  std::pair<double, double> total{0.0, 0.0};
  for (const NdtCost::Point& point : points) {
    const Eigen::Vector3d x = T * Eigen::Vector3f(point.x, point.y, point.z).cast<double>() - origin_m;
    const Eigen::Vector3d cube = (x / 2.0).array().floor();
    const Eigen::Vector3d beside = x / 2.0 - cube;
    if (beside.minCoeff() < 1e-5 || beside.maxCoeff() > 1.0 - 1e-5) {
      total.second += 1000.0;
      continue;
    }
    if ((cube.array() < 0.0).any() || cube.x() > 5.0 || cube.y() > 4.0 || cube.z() > 3.0) continue;
    const auto number = static_cast<std::size_t>(cube.x() + 6.0 * cube.y() + 30.0 * cube.z());
    const double step = 8.0 * (roots[number] * (x - means_m[number])).squaredNorm();
    total.first += step + 1.0 < 255.0 ? map[static_cast<std::size_t>(step * 1.0001 + 0.01)] : 0.0;
    total.second += step < 255.0 ? map[static_cast<std::size_t>(std::max(step * 0.9999 - 0.01, 0.0))] : 0.0;
  }
  return total;
}

NdtCost::Pose packed_pose(const Eigen::Isometry3d& T) {
  NdtCost::Pose pose;
  for (Eigen::Index i = 0; i < 9; ++i) pose.rotation[i] = static_cast<float>(T.linear()(i / 3, i % 3));
  for (Eigen::Index i = 0; i < 3; ++i) pose.translation_m[i] = static_cast<float>(T.translation()(i));
  return pose;
}

TEST(NdtScores, AreThoseOfTheirDefinitionInDouble) {
  Random random(5);
  const NdtWorld world(random);
  const auto unit = [&] { return random.uniform(-1.0, 1.0); };
  std::vector<NdtCost::Point> points;
  for (int i = 0; i < 700; ++i) {
    points.push_back(
        {static_cast<float>(7.0 * unit()), static_cast<float>(6.0 * unit()), static_cast<float>(5.0 * unit())});
  }
  std::vector<Eigen::Isometry3d> poses;
  std::vector<NdtCost::Pose> packed;
  for (int i = 0; i < 60; ++i) {
    Eigen::Isometry3d T(Eigen::AngleAxisd(3.0 * unit(), Eigen::Vector3d(unit(), unit(), unit()).normalized()));
    const Eigen::Vector3d to_m = world.origin_m + Eigen::Vector3d(6.0 + unit(), 5.0 + unit(), 4.0 + unit());
    T.pretranslate(to_m.cast<float>().cast<double>().eval());
    poses.push_back(T);
    packed.push_back(packed_pose(T));
  }
  for (const Isa isa : available_isas()) {
    const std::vector<std::uint32_t> found = world.scores(isa, points, packed);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto [least, most] = world.range(points, poses[i]);
      EXPECT_GE(found[i], least) << to_string(isa) << ", pose " << i;
      EXPECT_LE(found[i], most) << to_string(isa) << ", pose " << i;
      EXPECT_LT(most - least, 0.2 * most) << "the range says little";
    }
  }
}

// exp(0) for each point, and less for each that is off its mean.
TEST(NdtScores, AreGreatestWherePointsLieOnTheMeans) {
  Random random(6);
  const NdtWorld world(random);
  std::vector<NdtCost::Point> means;
  for (const Eigen::Vector3d& mean_m : world.means_m) {
    const Eigen::Vector3f m = mean_m.cast<float>();
    means.push_back({m.x(), m.y(), m.z()});
  }
  std::vector<NdtCost::Pose> poses(4);
  for (NdtCost::Pose& pose : poses) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      pose.translation_m[axis] = static_cast<float>(world.origin_m(static_cast<Eigen::Index>(axis)));
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) poses[axis + 1].translation_m[axis] += 0.125F;
  for (const Isa isa : available_isas()) {
    const std::vector<std::uint32_t> found = world.scores(isa, means, poses);
    EXPECT_EQ(found[0], means.size() * usual_table()[0]);
    for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LT(found[i], 0.97 * found[0]);
  }
}

// A point that is drawn from its distribution has a q of chi-squared with three degrees of freedom, whose mean of
// exp(-q / 6) is (1 + 1/3)^(-3/2) = 0.6495.
TEST(NdtScores, OfPointsDrawnFromTheDistributionsAreThoseOfTheory) {
  Random random(7);
  const NdtWorld world(random);
  std::vector<NdtCost::Point> points;
  for (int i = 0; i < 60000; ++i) {
    const auto number = static_cast<std::size_t>(i) % world.means_m.size();
    const Eigen::Vector3d drawn(random.normal(0.0, 1.0), random.normal(0.0, 1.0), random.normal(0.0, 1.0));
    const Eigen::Vector3f p = (world.means_m[number] + world.roots[number].inverse() * drawn).cast<float>();
    points.push_back({p.x(), p.y(), p.z()});
  }
  Eigen::Isometry3d at_origin = Eigen::Isometry3d::Identity();
  at_origin.translation() = world.origin_m;
  const std::vector<std::uint32_t> found = world.scores(best_isa(), points, {packed_pose(at_origin)});
  EXPECT_NEAR(found[0] / 60000.0, 649.5, 5.0);  // a few points lie beyond their cubes
}

TEST(NdtMap, RefusesTablesWhoseSumsMayOverflow) {
  Table table{};
  table[3] = NdtCost::kMostScore;
  EXPECT_EQ(make_ndt_map(table, {}, {}).size(), NdtCost::kSteps);
  ++table[3];
  EXPECT_THROW(make_ndt_map(table, {}, {}), Error);
  table[3] = 0;
  table.back() = 1;
  EXPECT_THROW(make_ndt_map(table, {}, {}), Error);
}

TEST(NdtScores, OfTheMostPointsDoNotOverflow) {
  Table table{};
  table[0] = NdtCost::kMostScore;
  const std::int32_t only = 0;
  const std::vector<std::uint32_t> map = make_ndt_map(table, std::vector<NdtCost::Distribution>(1), {&only, 1});
  const NdtCost::Params params{
      .point_count = NdtCost::kMostPoints, .size_x = 1, .size_y = 1, .size_z = 1, .distribution_count = 1};
  const std::vector<NdtCost::Point> points(NdtCost::kMostPoints);
  std::uint32_t score = 0;
  ndt_cost_host(best_isa(), params, map, points, std::vector<NdtCost::Pose>(1), {&score, 1});
  EXPECT_EQ(score, std::uint64_t{NdtCost::kMostPoints} * NdtCost::kMostScore);
}

}  // namespace
}  // namespace gdtslam::test
