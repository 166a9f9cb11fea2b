#include "transform3.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/core/ascii.hpp"
#include "engine/core/elementary.hpp"
#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr int kMostSteps = 32;  // limit on steps up a tree of frames, which may have a cycle
constexpr std::size_t kMostFramesTold = 12;
constexpr std::array<std::string_view, 3> kBaseNames{"base_link", "base_footprint", "base"};

// A quaternion loses the last bits of an angle. An angle that differs from one of nine decimals only by them is that
// one.
double unrounded_heading(double heading_rad) {
  constexpr double kParts = 1e9;
  constexpr double kLost_rad = 2e-15;
  const double whole_rad = std::floor(heading_rad * kParts + 0.5) / kParts;
  return std::fabs(whole_rad - heading_rad) <= kLost_rad ? whole_rad : heading_rad;
}

bool is_base(const std::string& frame, const std::string& base) {
  if (!base.empty()) return frame == base;
  return std::find(kBaseNames.begin(), kBaseNames.end(), name_in_namespace(frame)) != kBaseNames.end();
}

}  // namespace

bool Transform3::is_finite() const {
  const auto finite = [](double value) { return std::isfinite(value); };
  return std::all_of(rotation.begin(), rotation.end(), finite) && std::all_of(shift_m.begin(), shift_m.end(), finite);
}

Transform3 operator*(const Transform3& a, const Transform3& b) {
  Transform3 product;
  for (std::size_t i = 0; i < 3; ++i) {
    const double* const row = a.rotation.data() + 3 * i;
    for (std::size_t j = 0; j < 3; ++j) {
      product.rotation[3 * i + j] = row[0] * b.rotation[j] + row[1] * b.rotation[3 + j] + row[2] * b.rotation[6 + j];
    }
    product.shift_m[i] = row[0] * b.shift_m[0] + row[1] * b.shift_m[1] + row[2] * b.shift_m[2] + a.shift_m[i];
  }
  return product;
}

Pose2 seen_from_above(const Transform3& transform) {
  return {transform.shift_m[0], transform.shift_m[1],
          unrounded_heading(atan2(transform.rotation[3], transform.rotation[0]))};
}

std::string_view name_in_namespace(std::string_view frame) { return frame.substr(frame.rfind('/') + 1); }

std::string_view frame_namespace(std::string_view frame) { return frame.substr(0, frame.rfind('/') + 1); }

bool is_odometry_frame(std::string_view frame) {
  return in_small_letters(name_in_namespace(frame)).find("odom") != std::string::npos;
}

void FrameTree::add(const std::string& parent, const std::string& child, const Transform3& T_parent_child) {
  if (edges_.size() >= kMostFrames && !edges_.contains(child)) return;
  edges_[child] = {parent, T_parent_child};
}

std::optional<Transform3> FrameTree::find(const std::string& frame, const std::string& base) const {
  const std::vector<std::string> frames = chain(frame, base);
  if (frames.empty()) return std::nullopt;
  Transform3 T_here_frame;
  for (std::size_t k = 0; k + 1 < frames.size(); ++k) {
    T_here_frame = edges_.find(frames[k])->second.T_parent_child * T_here_frame;
  }
  return T_here_frame;
}

std::vector<std::string> FrameTree::chain(const std::string& frame, const std::string& base) const {
  const std::string in_namespace = std::string(frame_namespace(base)) + frame;
  std::vector<std::string> frames{!edges_.contains(frame) && edges_.contains(in_namespace) ? in_namespace : frame};
  for (int step = 0; step < kMostSteps; ++step) {
    if (is_base(frames.back(), base)) return frames;
    const auto edge = edges_.find(frames.back());
    if (edge == edges_.end()) break;
    frames.push_back(edge->second.parent);
  }
  return {};
}

std::string FrameTree::text() const {
  std::string text;
  std::size_t told = 0;
  for (const auto& [child, edge] : edges_) {
    if (told++ == kMostFramesTold) return text + " and others";
    text += fmt::format("{}{} in {}", text.empty() ? "" : ", ", in_quotes(child), in_quotes(edge.parent));
  }
  return text.empty() ? "none" : text;
}

}  // namespace gdtslam
