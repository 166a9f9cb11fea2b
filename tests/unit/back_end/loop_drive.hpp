// A drive around a corridor whose walls and poses are known, and what a front end with known noise makes of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/mapping/loops/measured_path.hpp"
#include "engine/mapping/surface/surface_points.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"
#include "support/room.hpp"

namespace gdtslam::test {

/// Of the path around that corridor, from pose to pose.
inline constexpr double kRingRound_m = 2.0 * (26.0 + 14.0) + 36.0 * 3.14159265358979 / 18.0;

inline void add_box(std::vector<Segment>& walls, const Point2& low, const Point2& high) {
  walls.push_back({low, {high.x(), low.y()}});
  walls.push_back({{high.x(), low.y()}, high});
  walls.push_back({high, {low.x(), high.y()}});
  walls.push_back({{low.x(), high.y()}, low});
}

/// A corridor around a block of 26 x 14 m, with niches at unequal distances, turned out of the grid.
inline std::vector<Segment> ring_corridor() {
  std::vector<Segment> walls;
  add_box(walls, {-15.0, -9.0}, {15.0, 9.0});
  add_box(walls, {-13.0, -7.0}, {13.0, 7.0});
  for (const double x : {-11.0, -6.5, -1.0, 2.0, 8.5}) add_box(walls, {x, -9.0}, {x + 0.5, -8.7});
  for (const double x : {-9.0, -3.5, 4.5, 6.0, 11.0}) add_box(walls, {x, 8.6}, {x + 0.6, 9.0});
  for (const double y : {-4.0, 1.5, 3.0}) add_box(walls, {14.7, y}, {15.0, y + 0.7});
  for (const double y : {-5.5, -1.0, 4.0}) add_box(walls, {-15.0, y}, {-14.6, y + 0.5});
  const Pose2 turned{0.011, 0.007, 0.21};
  for (Segment& wall : walls) wall = {turned * wall.from, turned * wall.to};
  return walls;
}

/// A passage around a block with rooms of many widths and depths on its outside, 3 m deep at most: no two stretches of
/// it look alike. The drive is that of poses_around_ring().
inline std::vector<Segment> rooms_around_a_block() {
  const Pose2 turned{0.011, 0.007, 0.21};
  std::vector<Segment> walls;
  add_box(walls, {-18.0, -12.0}, {18.0, 12.0});
  add_box(walls, {-13.0, -7.0}, {13.0, 7.0});
  struct Pier {
    double from, to, depth_m;
  };
  for (const Pier& p : {Pier{-15.0, -12.2, 2.9},
                        {-10.9, -10.1, 2.2},
                        {-7.0, -3.4, 1.3},
                        {-1.5, 1.0, 2.8},
                        {3.2, 3.9, 2.9},
                        {7.5, 9.0, 0.9},
                        {11.0, 14.5, 2.6}}) {
    add_box(walls, {p.from, -12.0}, {p.to, -12.0 + p.depth_m});
  }
  for (const Pier& p : {Pier{-13.0, -11.4, 1.7},
                        {-9.0, -4.8, 2.7},
                        {-2.6, -2.0, 2.9},
                        {0.7, 5.1, 0.8},
                        {6.0, 8.8, 2.4},
                        {12.0, 13.0, 2.9}}) {
    add_box(walls, {p.from, 12.0 - p.depth_m}, {p.to, 12.0});
  }
  for (const Pier& p : {Pier{-8.0, -5.7, 2.5}, {-2.2, -1.6, 2.9}, {1.8, 6.2, 1.1}}) {
    add_box(walls, {18.0 - p.depth_m, p.from}, {18.0, p.to});
  }
  for (const Pier& p : {Pier{-7.1, -6.5, 2.8}, {-3.3, 1.2, 1.9}, {4.0, 7.5, 2.8}}) {
    add_box(walls, {-18.0, p.from}, {-18.0 + p.depth_m, p.to});
  }
  for (Segment& wall : walls) wall = {turned * wall.from, turned * wall.to};
  return walls;
}

/// Along the middle of that corridor, a keyframe each 0.25 m or 10 degrees.
inline std::vector<Pose2> poses_around_ring(int rounds) {
  const Pose2 turned{0.011, 0.007, 0.21};
  std::vector<Pose2> poses;
  Pose2 pose{-13.0, -8.0, 0.0};
  const auto straight = [&](double length_m) {
    for (int k = 0; k < static_cast<int>(std::lround(length_m / 0.25)); ++k) {
      poses.push_back(turned * pose);
      pose = pose * Pose2{0.25, 0.0, 0.0};
    }
  };
  const auto corner = [&] {
    for (int k = 0; k < 9; ++k) {
      poses.push_back(turned * pose);
      pose = pose * exp_se2({1.0 * kPi / 18.0, 0.0, kPi / 18.0});
    }
  };
  for (int round = 0; round < rounds; ++round) {
    straight(26.0);
    corner();
    straight(14.0);
    corner();
    straight(26.0);
    corner();
    straight(14.0);
    corner();
  }
  return poses;
}

/// What wheels tell of a drive whose steps fall short by a tenth.
inline std::vector<Pose2> odometry_short_by_a_tenth(const std::vector<Pose2>& truth) {
  std::vector<Pose2> odometry(1);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Pose2 step = between(truth[i - 1], truth[i]);
    odometry.push_back(odometry.back() * Pose2{0.9 * step.x_m, 0.9 * step.y_m, step.theta_rad});
  }
  return odometry;
}

/// Driven by wheels with this noise a step, where the truth is known.
struct LoopDrive {
  std::vector<Pose2> truth;
  FrontEndPath path;
};

inline LoopDrive drive_around_ring(int rounds, double sigma_m, double sigma_rad, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Segment> walls = ring_corridor();
  LoopDrive result;
  result.truth = poses_around_ring(rounds);
  const Matrix3 information = inverse(Matrix3::diagonal(sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad));
  for (std::size_t i = 0; i < result.truth.size(); ++i) {
    const LaserScan scan = scan_of(walls, result.truth[i], 0.0, 180);
    result.path.scans.push_back(keep_scan(to_points(scan, {})));
    const KeptScan& kept = result.path.scans[i];
    if (i == 0) {
      result.path.poses.push_back(result.truth.front());
      result.path.path_m.push_back(0.0);
      result.path.doubts.emplace_back();
      result.path.steps.emplace_back();
      result.path.travels.emplace_back();
      continue;
    }
    const Pose2 step = between(result.truth[i - 1], result.truth[i]);
    const double x = random.normal(0.0, sigma_m);
    const double y = random.normal(0.0, sigma_m);
    const double turn = random.normal(0.0, sigma_rad);
    const Pose2 measured = step * exp_se2({x, y, turn});
    result.path.poses.push_back(result.path.poses.back() * measured);
    result.path.steps.push_back({MeasuredStep{measured, information}, MeasuredStep{measured, 0.01 * information}});
    result.path.doubts.push_back(step_doubt(result.path.steps.back()));
    result.path.travels.push_back({.path_m = translation_length(measured),
                                   .turned_rad = std::fabs(measured.theta_rad),
                                   .is_way_known = knows_way(kept, inverse(measured).translation())});
    result.path.path_m.push_back(result.path.path_m.back() + step.translation().norm());
  }
  return result;
}

inline double largest_error_m(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    largest = std::max(largest, (poses[i].translation() - truth[i].translation()).norm());
  }
  return largest;
}

}  // namespace gdtslam::test
