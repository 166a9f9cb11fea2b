// Films of a cloud: once around it, and behind the robot along its path.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/viewer/film.hpp"

namespace gdtslam {
namespace {

constexpr double kFollowDistance_m = 3.2;  // from the robot to the eye, horizontally
constexpr double kSmoothed_s = 1.5;        // on each side, for averaging the eye's position
constexpr double kSmoothedFrames = 6.0;    // or this number of frames if that is longer
constexpr int kSmoothingSteps = 8;         // on each side
constexpr double kJitter_s = 1.0;          // larger steps back mean that a clock was set

class CloudFilm : public Film {
 public:
  CloudFilm(CloudScene& scene, const CloudLook& look, CloudCaption caption, const PictureSize& size, std::size_t frames)
      : scene_(scene), look_(look), caption_(std::move(caption)), size_(size), frames_(frames) {}
  [[nodiscard]] std::size_t frames() const override { return frames_; }

 protected:
  /// Grows from 0 to 1 from the first frame to the last.
  [[nodiscard]] double film_share(std::size_t k) const {
    return frames_ > 1 ? static_cast<double>(k) / static_cast<double>(frames_ - 1) : 1.0;
  }
  Canvas picture(const Camera& camera) {
    return cloud_picture(std::make_shared<const RgbaImage>(scene_.render(camera, size_)), scene_.scale(), camera, look_,
                         caption_);
  }

  CloudScene& scene_;
  CloudLook look_;
  CloudCaption caption_;
  PictureSize size_;
  std::size_t frames_;
};

class OrbitFilm : public CloudFilm {
 public:
  using CloudFilm::CloudFilm;

  Canvas frame(std::size_t k) override {
    const double angle_rad = kTwoPi * static_cast<double>(k) / static_cast<double>(frames());
    return picture(turned(orbit_camera(scene_.bounds(), size_), angle_rad));
  }
};

// Points are shown by their stamps, which are ambiguous if a clock was set back.
void require_times_that_go_on(const Trajectory& trajectory) {
  double latest_s = trajectory.front().stamp_s;
  double back_s = 0.0;
  for (const StampedPose& pose : trajectory) {
    latest_s = std::max(latest_s, pose.stamp_s);
    back_s = std::max(back_s, latest_s - pose.stamp_s);
  }
  if (back_s <= kJitter_s && trajectory.back().stamp_s >= trajectory.front().stamp_s) return;
  throw InputError(
      fmt::format("the times of its path step back by {:.3g} s, and a film that follows the robot needs "
                  "times that go on; the view orbit needs none",
                  back_s));
}

Pose2 pose_at(const Trajectory& trajectory, double stamp_s) {
  const auto next = std::find_if(trajectory.begin(), trajectory.end(),
                                 [stamp_s](const StampedPose& pose) { return pose.stamp_s >= stamp_s; });
  if (next == trajectory.begin()) return next->T_map_base;
  const StampedPose& before = *(next - 1);
  if (next == trajectory.end() || !(next->stamp_s > before.stamp_s)) return before.T_map_base;
  const double share = (stamp_s - before.stamp_s) / (next->stamp_s - before.stamp_s);
  return before.T_map_base * exp_se2(share * log_se2(between(before.T_map_base, next->T_map_base)));
}

// The robot's last position at the camera's distance: the eye moves along the robot's own path, which is free of walls.
// Before the path begins it moves straight back.
Point2 place_behind(const Trajectory& trajectory, double stamp_s) {
  const Point2 robot = pose_at(trajectory, stamp_s).translation();
  const auto past = [stamp_s](const StampedPose& pose) { return pose.stamp_s > stamp_s; };
  auto at = std::find_if(trajectory.begin(), trajectory.end(), past);
  Point2 nearer = robot;
  while (at != trajectory.begin()) {
    --at;
    const Point2 farther = at->T_map_base.translation();
    const double far_m = (farther - robot).norm();
    const double near_m = (nearer - robot).norm();
    if (far_m >= kFollowDistance_m) {
      const double share = far_m > near_m ? (kFollowDistance_m - near_m) / (far_m - near_m) : 1.0;
      return nearer + share * (farther - nearer);
    }
    nearer = farther;
  }
  const Pose2& first = trajectory.front().T_map_base;
  const double left_m = kFollowDistance_m - (first.translation() - robot).norm();
  return first * Point2(-left_m, 0.0);
}

class FollowFilm : public CloudFilm {
 public:
  FollowFilm(CloudScene& scene, Trajectory trajectory, const CloudLook& look, const CloudCaption& caption,
             const PictureSize& size, std::size_t frames)
      : CloudFilm(scene, look, caption, size, frames), trajectory_(std::move(trajectory)) {
    std::erase_if(trajectory_,
                  [](const StampedPose& pose) { return !pose.T_map_base.is_finite() || !std::isfinite(pose.stamp_s); });
    if (trajectory_.empty()) throw InputError("a film that follows the robot needs its path; the trajectory is empty");
    require_times_that_go_on(trajectory_);
    const double length_s = trajectory_.back().stamp_s - trajectory_.front().stamp_s;
    smoothed_s_ = std::max(kSmoothed_s, kSmoothedFrames * length_s / static_cast<double>(frames));
  }
  FollowFilm(const FollowFilm&) = delete;
  FollowFilm& operator=(const FollowFilm&) = delete;
  ~FollowFilm() override {
    scene_.show_until(std::numeric_limits<double>::infinity());
    scene_.set_robot(std::nullopt);
  }

  Canvas frame(std::size_t k) override {
    const double first_s = trajectory_.front().stamp_s;
    // The last frame's time equals the last pose's to the bit, so that the film ends with all points measured until
    // then.
    const double stamp_s = k + 1 == frames() ? trajectory_.back().stamp_s
                                             : first_s + film_share(k) * (trajectory_.back().stamp_s - first_s);
    const Pose2 pose = pose_at(trajectory_, stamp_s);
    scene_.show_until(stamp_s);
    scene_.set_robot(pose);
    return picture(follow_camera(eye_place(stamp_s), pose));
  }

 private:
  /// The mean around this time, which smooths jerks.
  [[nodiscard]] Point2 eye_place(double stamp_s) const {
    Point2 sum = Point2::Zero();
    double weights = 0.0;
    for (int k = -kSmoothingSteps; k <= kSmoothingSteps; ++k) {
      const double at_s = std::clamp(stamp_s + smoothed_s_ * k / kSmoothingSteps, trajectory_.front().stamp_s,
                                     trajectory_.back().stamp_s);
      const double weight = kSmoothingSteps + 1 - std::abs(k);
      sum += weight * place_behind(trajectory_, at_s);
      weights += weight;
    }
    return sum / weights;
  }

  Trajectory trajectory_;
  double smoothed_s_ = kSmoothed_s;
};

}  // namespace

std::unique_ptr<Film> orbit_film(CloudScene& scene, const CloudLook& look, const CloudCaption& caption,
                                 const PictureSize& size, std::size_t frames) {
  return std::make_unique<OrbitFilm>(scene, look, caption, size, frames);
}

std::unique_ptr<Film> follow_film(CloudScene& scene, const Trajectory& trajectory, const CloudLook& look,
                                  const CloudCaption& caption, const PictureSize& size, std::size_t frames) {
  return std::make_unique<FollowFilm>(scene, trajectory, look, caption, size, frames);
}

}  // namespace gdtslam
