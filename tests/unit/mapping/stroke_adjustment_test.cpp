// The adjustment of strokes in a box room whose faces are known: a robot sways on its way, and its points are computed
// as if it did not.
#include "engine/mapping/strokes/stroke_adjustment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/mapping/strokes/path_correction.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

constexpr double kScanStep_s = 0.05;
constexpr std::uint32_t kScans = 1200;
constexpr int kBeams = 121;
constexpr double kSwing_rad = 0.9;
constexpr double kNod_s = 8.0;  // two strokes
constexpr double kRangeNoise_m = 0.01;
const double kSway_rad = rad_from_deg(0.5);

const Point3 kRoomLow(-4.2, -3.2, 0.0);
const Point3 kRoomHigh(3.8, 2.8, 2.8);

/// Range along a ray from inside the room.
double range_to_faces_m(const Point3& from, const Point3& direction) {
  double range_m = std::numeric_limits<double>::infinity();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double face = direction[axis] > 0.0 ? kRoomHigh[axis] : kRoomLow[axis];
    if (direction[axis] != 0.0) range_m = std::min(range_m, (face - from[axis]) / direction[axis]);
  }
  return range_m;
}

double distance_to_faces_m(const CloudPoint& point) {
  const Eigen::Array3d p(static_cast<double>(point.x_m), static_cast<double>(point.y_m),
                         static_cast<double>(point.z_m));
  return std::min((p - kRoomLow.array()).abs().minCoeff(), (p - kRoomHigh.array()).abs().minCoeff());
}

double mean_distance_to_faces_m(const Cloud& cloud) {
  double sum_m = 0.0;
  for (const CloudPoint& point : cloud) sum_m += distance_to_faces_m(point);
  return sum_m / static_cast<double>(cloud.size());
}

/// Roll, pitch and heave of the robot at a time, and the error of the elevations.
struct Sway {
  double tilt_rad = 0.0;
  double heave_m = 0.0;
  double elevation_rad = 0.0;

  [[nodiscard]] Pose3 T_plane_base(double time_s) const {
    const Point3 turn(tilt_rad * std::sin(kTwoPi * time_s / 23.0), tilt_rad * std::sin(kTwoPi * time_s / 17.0), 0.0);
    return {{0.0, 0.0, heave_m * std::sin(kTwoPi * time_s / 29.0)}, exp_so3(turn)};
  }
  [[nodiscard]] double elevation_error_rad(double elevation) const {
    return elevation_rad * std::sin(kPi * elevation / kSwing_rad);
  }
};

Pose2 straight_way(double time_s) { return {-2.0 + 0.06 * time_s, 0.3, 0.1}; }
/// Through all of the room, so that surfaces are seen from near and far.
Pose2 round_way(double time_s) {
  return {2.5 * std::sin(kTwoPi * time_s / 53.0), 1.6 * std::sin(kTwoPi * time_s / 31.0), kTwoPi * time_s / 45.0};
}

struct RoomDrive {
  RoomDrive(const Sway& sway, Pose2 (*planar_pose)(double), double nod_s = kNod_s);
  PlanarPath path;
  std::vector<Pose3> T_map_base;
  Cloud cloud;       ///< as if the robot did not sway
  Cloud true_cloud;  ///< with the noise of the ranges alone
};

RoomDrive::RoomDrive(const Sway& sway, Pose2 (*planar_pose)(double), double nod_s) {
  Random random(3);
  path.axis_base_m = {0.1, 0.0, 0.5};
  for (std::uint32_t scan = 0; scan < kScans; ++scan) {
    const double stamp_s = kScanStep_s * scan;
    const Pose3 T_map_plane = embed(planar_pose(stamp_s));
    T_map_base.push_back(T_map_plane * sway.T_plane_base(stamp_s));
    const double elevation_rad = kSwing_rad * std::sin(kTwoPi * stamp_s / nod_s);
    const double true_rad = elevation_rad + sway.elevation_error_rad(elevation_rad);
    path.poses.push_back({stamp_s, planar_pose(stamp_s)});
    for (int beam = 0; beam < kBeams; ++beam) {
      const double bearing = rad_from_deg(-120.0 + 240.0 * beam / (kBeams - 1));
      const Point3 ray(std::cos(bearing), std::sin(bearing), 0.0);
      const Point3 true_ray = Eigen::AngleAxisd(-true_rad, Point3::UnitY()) * ray;
      const Point3 taken_ray = Eigen::AngleAxisd(-elevation_rad, Point3::UnitY()) * ray;
      const double range_m =
          range_to_faces_m(T_map_base.back() * path.axis_base_m, T_map_base.back().rotation * true_ray) +
          kRangeNoise_m * random.normal();
      const auto add = [&](Cloud& to, const Point3& at) {
        to.push_back({static_cast<float>(at.x()), static_cast<float>(at.y()), static_cast<float>(at.z()),
                      static_cast<float>(elevation_rad), stamp_s, scan});
      };
      add(cloud, T_map_plane * (path.axis_base_m + range_m * taken_ray));
      add(true_cloud, T_map_base.back() * (path.axis_base_m + range_m * true_ray));
    }
  }
}

/// What the strokes of a cloud give.
struct Collected {
  explicit Collected(const RoomDrive& drive) : path(drive.path) {
    SurfelCollector collector({});
    collector.add(drive.cloud);
    surfels = collector.finish();
    path.strokes = collector.strokes();
  }
  std::vector<Surfel> surfels;
  PlanarPath path;
};

struct Adjusted {
  explicit Adjusted(const RoomDrive& drive, unsigned threads = 2)
      : collected(drive), correction(collected.path, -kSwing_rad, kSwing_rad) {
    WorkerPool workers(threads);
    found = adjust_strokes(collected.surfels, {}, workers, correction, [](double) {});
    cloud = drive.cloud;
    correction.correct(cloud);
  }
  Collected collected;
  PathCorrection correction;
  StrokeAdjustment found;
  Cloud cloud;
};

/// How much farther from the faces the points lie than the noise of the ranges explains.
double excess_m(const Cloud& cloud, const RoomDrive& drive) {
  return mean_distance_to_faces_m(cloud) - mean_distance_to_faces_m(drive.true_cloud);
}

TEST(AdjustStrokes, FindsTheSwayOfARobot) {
  const RoomDrive drive({.tilt_rad = kSway_rad, .heave_m = 0.01}, straight_way);
  const Adjusted adjusted(drive);
  ASSERT_GT(excess_m(drive.cloud, drive), 0.004);
  EXPECT_LT(excess_m(adjusted.cloud, drive), 0.2 * excess_m(drive.cloud, drive));
  EXPECT_LT(adjusted.found.rms_m, 0.5 * adjusted.found.rms_before_m);
  const std::vector<Pose3> poses = adjusted.correction.poses();
  double sq_tilt = 0.0;
  double sq_height = 0.0;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Pose3& expected = drive.T_map_base[k];
    sq_tilt += log_so3(expected.rotation * poses[k].rotation.conjugate()).head<2>().squaredNorm();
    sq_height += std::pow(poses[k].translation_m.z() - expected.translation_m.z(), 2);
  }
  // The sway itself has an rms of 0.5 deg and 7 mm. Changes within a stroke are found in part only.
  EXPECT_LT(deg_from_rad(std::sqrt(sq_tilt / kScans)), 0.2);
  EXPECT_LT(std::sqrt(sq_height / kScans), 0.004);
}

// Also where scan lines lie far apart.
TEST(AdjustStrokes, LeavesAFlatPathFlat) {
  for (const double nod_s : {kNod_s, 2.9}) {
    const RoomDrive drive({}, straight_way, nod_s);
    const Adjusted adjusted(drive);
    EXPECT_LT(deg_from_rad(adjusted.found.rms_correction.segment<2>(3).norm()), 0.05) << nod_s;
    EXPECT_LT(adjusted.found.rms_correction.head<3>().norm(), 0.004) << nod_s;
    EXPECT_LT(excess_m(adjusted.cloud, drive), 0.0003) << nod_s;
    for (const double knot_rad : adjusted.correction.elevation_knots_rad) {
      EXPECT_LT(deg_from_rad(std::fabs(knot_rad)), 0.06) << nod_s;
    }
  }
}

// A constant error of the elevation is a pitch. One by its tangent lowers the floor and raises the ceiling as a whole,
// which strokes hardly show. What is left of the error after both is compared.
TEST(AdjustStrokes, FindsTheErrorOfTheElevations) {
  const Sway sway{.elevation_rad = kSway_rad};
  const RoomDrive drive(sway, round_way);
  const Adjusted adjusted(drive);
  ASSERT_GT(excess_m(drive.cloud, drive), 0.001);
  EXPECT_LT(excess_m(adjusted.cloud, drive), 0.5 * excess_m(drive.cloud, drive));
  constexpr auto kKnots = static_cast<Eigen::Index>(PathCorrection::kElevationKnots);
  Eigen::MatrixX2d unseen(kKnots, 2);
  Eigen::VectorXd expected(kKnots);
  for (Eigen::Index k = 0; k < kKnots; ++k) {
    constexpr auto kHalf = static_cast<Eigen::Index>(PathCorrection::kKnotsOfAStroke);  // rising, then falling
    const double elevation_rad = kSwing_rad * (2.0 * static_cast<double>(k % kHalf) / (kHalf - 1) - 1.0);
    unseen.row(k) << 1.0, std::tan(elevation_rad);
    expected[k] = sway.elevation_error_rad(elevation_rad);
  }
  const auto seen_rms_deg = [&](const Eigen::VectorXd& curve) {
    const Eigen::VectorXd left = curve - unseen * unseen.householderQr().solve(curve);
    return deg_from_rad(left.norm() / std::sqrt(static_cast<double>(kKnots)));
  };
  const Eigen::Map<const Eigen::VectorXd> found(adjusted.correction.elevation_knots_rad.data(), kKnots);
  EXPECT_LT(seen_rms_deg(found - expected), 0.5 * seen_rms_deg(expected));
}

TEST(AdjustStrokes, TheNumberOfThreadsDoesNotChangeABit) {
  const RoomDrive drive({.tilt_rad = kSway_rad, .heave_m = 0.01, .elevation_rad = kSway_rad}, straight_way);
  const Adjusted one(drive, 1);
  const Adjusted four(drive, 4);
  EXPECT_EQ(one.correction.knots, four.correction.knots);
  EXPECT_EQ(one.correction.elevation_knots_rad, four.correction.elevation_knots_rad);
  EXPECT_EQ(one.cloud, four.cloud);
}

}  // namespace
}  // namespace gdtslam
