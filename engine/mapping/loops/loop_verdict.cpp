#include "loop_verdict.hpp"

#include <algorithm>
#include <cstddef>

namespace gdtslam {
namespace {

constexpr double kOnWall_m = 0.15;
constexpr double kSameSide = 0.5;            // least cosine between normals
constexpr double kGroupPointNoise_m = 0.05;  // noise of a point of a group: its own scans drift a little
constexpr double kGroupIndependent = 60.0;   // independent points
// In a direction in which little constrains a group the search stays at its start pose, which is no measurement:
// hundreds of loops along a corridor would together confirm the drifted path. So the information that tilted normals
// could feign counts as nothing, and as much again: two points of a hundred that stand across a corridor often lie on
// another door than the one they are matched with.
constexpr double kGroupLeastShape = 1.0e-10;
constexpr double kShapeOfFewWalls = 2.0 * kShapeOfTiltedNormals;
constexpr double kLoopFloor_m = 0.03;
constexpr double kLoopFloor_rad = 0.006;
constexpr std::size_t kEvery = 4;  // stride through the reference's points, which are many

struct Shares {
  std::size_t wrong = 0;
  std::size_t known = 0;
};

// Counts the points at T that lie in free space, and all points in known cells.
Shares in_free_space(const std::vector<Point2>& points, const Pose2& T, const FreeSpace& space, std::size_t every) {
  Shares shares;
  const PointMotion placed(T);
  for (std::size_t i = 0; i < points.size(); i += every) {
    const Point2 point = placed(points[i]);
    if (!space.is_known(point)) continue;
    ++shares.known;
    shares.wrong += space.is_free(point) ? 1U : 0U;
  }
  return shares;
}

/// The query's walls on walls of the reference.
struct CommonWalls {
  std::size_t same = 0;               // seen from the same side
  std::size_t other = 0;              // from the other side alone
  Matrix3 shape;                      // the sum over `same`
  std::vector<Matrix3> of_query;      // the sum for each keyframe of the query,
  std::vector<Matrix3> of_reference;  // and for each keyframe of the reference
};

CommonWalls common_walls(const ScanGroup& reference, const ScanGroup& query, const Pose2& T_reference_query) {
  CommonWalls common;
  common.of_query.resize(query.keyframes());
  common.of_reference.resize(reference.keyframes());
  const PointMotion in_reference(T_reference_query);
  for (const WallPoint& wall : query.space().walls()) {
    const Point2 point = in_reference(wall.point);
    const Point2 normal = in_reference.turned(wall.normal);
    double nearest_m2 = kOnWall_m * kOnWall_m;
    std::size_t keyframe = 0;
    bool is_same = false;
    bool is_other = false;
    reference.space().visit_walls_near(point, [&](const WallPoint& there) {
      const double dx = there.point.x() - point.x();
      const double dy = there.point.y() - point.y();
      const double away_m2 = dx * dx + dy * dy;
      if (away_m2 > kOnWall_m * kOnWall_m) return;
      const double cosine = there.normal.dot(normal);
      if (cosine > kSameSide && away_m2 <= nearest_m2) {
        nearest_m2 = away_m2;
        keyframe = there.keyframe;
        is_same = true;
      }
      is_other = is_other || cosine < -kSameSide;
    });
    common.other += is_other && !is_same ? 1U : 0U;
    if (!is_same) continue;
    ++common.same;
    const double lever = wall.point.x() * wall.normal.y() - wall.point.y() * wall.normal.x();
    const Tangent2 J{wall.normal.x(), wall.normal.y(), lever};
    const Matrix3 of_point = outer(J, J);
    common.shape += of_point;
    common.of_query[wall.keyframe] += of_point;
    common.of_reference[keyframe] += of_point;
  }
  return common;
}

// The shapes are for motions in the query's frame; the result is in that frame too.
Matrix3 doubt_of_reference(const ScanGroup& reference, std::vector<Matrix3> shapes, const Pose2& T_reference_query) {
  const Matrix3 carried = adjoint_matrix(inverse(T_reference_query));
  for (Matrix3& shape : shapes) shape = transposed_times(carried, shape * carried);
  return carried * times_transposed(reference.doubt().of_pose(shapes), carried);
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

}  // namespace

LoopEvidence weigh_loop(const ScanGroup& reference, const ScanGroup& query, const Pose2& T_reference_query) {
  const CommonWalls common = common_walls(reference, query, T_reference_query);
  const Shares there = in_free_space(query.points(), T_reference_query, reference.space(), 1);
  const Shares back = in_free_space(reference.points(), inverse(T_reference_query), query.space(), kEvery);
  const Matrix3 of_query = query.doubt().of_pose(common.of_query);
  const Matrix3 of_reference = doubt_of_reference(reference, common.of_reference, T_reference_query);
  return {.overlap = share(common.same, query.space().walls().size()),
          .turned = share(common.other, common.same + common.other),
          .contradiction = share(there.wrong + back.wrong, there.known + back.known),
          .shape = (common.same > 0 ? 1.0 / static_cast<double>(common.same) : 0.0) * common.shape,
          .doubt = of_query + of_reference};
}

bool is_possible(const LoopEvidence& evidence, const LoopLimits& limits) {
  return evidence.overlap >= limits.least_overlap && evidence.turned <= limits.most_turned &&
         evidence.contradiction <= limits.most_contradiction;
}

Matrix3 loop_information(const LoopEvidence& evidence) {
  const double weight = kGroupIndependent * evidence.overlap / (kGroupPointNoise_m * kGroupPointNoise_m);
  const Matrix3 information = weight * with_eigenvalues(eigen_of_symmetric(evidence.shape), [](double value) {
                                return std::max(kGroupLeastShape, value - kShapeOfFewWalls);
                              });
  const Matrix3 floor =
      Matrix3::diagonal(kLoopFloor_m * kLoopFloor_m, kLoopFloor_m * kLoopFloor_m, kLoopFloor_rad * kLoopFloor_rad);
  return inverse(inverse(information) + floor + evidence.doubt);
}

}  // namespace gdtslam
