#include "pose_matchers.hpp"

#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <utility>

namespace gdtslam {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

struct Apart {
  double metres;
  double degrees;
};

Apart apart(const Pose2& a, const Pose2& b) {
  const double turn_rad = std::remainder(a.theta_rad - b.theta_rad, 2.0 * std::numbers::pi);
  return {std::hypot(a.x_m - b.x_m, a.y_m - b.y_m), std::fabs(turn_rad) * kDegPerRad};
}

Apart apart(const Pose3& a, const Pose3& b) {
  const Eigen::Vector3d shift = a.translation_m - b.translation_m;
  const Eigen::Quaterniond turn = a.rotation.conjugate() * b.rotation;
  return {std::hypot(shift.x(), shift.y(), shift.z()),
          2.0 * std::atan2(turn.vec().norm(), std::fabs(turn.w())) * kDegPerRad};
}

std::string as_text(const Pose2& pose) { return testing::PrintToString(pose); }
std::string as_text(const Pose3& pose) { return testing::PrintToString(pose); }

template <class Pose>
class PoseNearMatcher : public testing::MatcherInterface<const Pose&> {
 public:
  PoseNearMatcher(Pose expected, Apart allowed) : expected_(std::move(expected)), allowed_(allowed) {}

  bool MatchAndExplain(const Pose& pose, testing::MatchResultListener* listener) const override {
    const Apart found = apart(pose, expected_);
    *listener << "which is " << found.metres << " m and " << found.degrees << " deg away";
    return found.metres <= allowed_.metres && found.degrees <= allowed_.degrees;
  }
  void DescribeTo(std::ostream* out) const override { describe(out, "is"); }
  void DescribeNegationTo(std::ostream* out) const override { describe(out, "is not"); }

 private:
  void describe(std::ostream* out, const char* verb) const {
    *out << verb << " within " << allowed_.metres << " m and " << allowed_.degrees << " deg of " << as_text(expected_);
  }

  Pose expected_;
  Apart allowed_;
};

}  // namespace

void PrintTo(const Pose2& pose, std::ostream* out) {
  const auto precision = out->precision(10);
  *out << "(" << pose.x_m << " m, " << pose.y_m << " m, " << pose.theta_rad * kDegPerRad << " deg)";
  out->precision(precision);
}

void PrintTo(const Pose3& pose, std::ostream* out) {
  const Eigen::Vector3d& t = pose.translation_m;
  const Eigen::Vector3d axis = pose.rotation.vec();
  const double turn_rad = 2.0 * std::atan2(axis.norm(), pose.rotation.w());
  const auto precision = out->precision(10);
  *out << "(" << t.x() << " m, " << t.y() << " m, " << t.z() << " m, " << turn_rad * kDegPerRad << " deg about ["
       << axis.x() << ", " << axis.y() << ", " << axis.z() << "])";
  out->precision(precision);
}

namespace test {

testing::Matcher<const Pose2&> PoseNear(const Pose2& expected, double metres, double degrees) {
  return testing::MakeMatcher(new PoseNearMatcher<Pose2>(expected, {metres, degrees}));
}

testing::Matcher<const Pose3&> PoseNear(const Pose3& expected, double metres, double degrees) {
  return testing::MakeMatcher(new PoseNearMatcher<Pose3>(expected, {metres, degrees}));
}

}  // namespace test
}  // namespace gdtslam
