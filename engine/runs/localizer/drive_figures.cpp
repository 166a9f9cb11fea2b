#include "drive_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "engine/core/quantile.hpp"
#include "engine/mapping/graph/matrix3.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

bool is_matched(const TrackedScan& scan) {
  return scan.pose.whereabouts == Whereabouts::kFound || scan.pose.whereabouts == Whereabouts::kTracked;
}

// Of the error along the map's axes; nothing where the covariance is none.
double squared_sigmas_of(const TrackedScan& scan) {
  const PoseCovariance& c = scan.pose.covariance;
  const Pose2& T = scan.pose.T_map_base;
  const Pose2& reference = scan.reference->T_map_base;
  const Tangent2 off{T.x_m - reference.x_m, T.y_m - reference.y_m, wrap_angle(T.theta_rad - reference.theta_rad)};
  return squared_norm(inverse(Matrix3{{c.xx, c.xy, c.xt, c.xy, c.yy, c.yt, c.xt, c.yt, c.tt}}), off);
}

class StretchCounter {
 public:
  void take(const TrackedScan& scan) {
    const bool is_unknown = scan.pose.whereabouts == Whereabouts::kUnknown;
    if (open_) {
      open_->lasted_s = scan.stamp_s - begin_s_;
      open_->is_found = !is_unknown;
    }
    if (!is_unknown) return close();
    if (!open_) {
      open_ = UnknownStretch{.first = scan.index};
      begin_s_ = scan.stamp_s;
    }
    ++open_->scans;
  }
  void close() {
    if (open_) stretches.push_back(*open_);
    open_.reset();
  }
  std::vector<UnknownStretch> stretches;

 private:
  std::optional<UnknownStretch> open_;
  double begin_s_ = 0.0;
};

void compare(const TrackedScan& scan, DriveFigures& figures, std::vector<double>& distances_m,
             std::vector<double>& angles_deg, std::vector<double>& squared_sigmas) {
  const TrackReference& reference = *scan.reference;
  if (!reference.is_mapped) {
    ++figures.unmapped;
    return;
  }
  ++figures.within.of;
  if (!reference.is_within) {
    ++(scan.pose.whereabouts == Whereabouts::kUnknown ? figures.without : figures.off);
    return;
  }
  ++figures.within.count;
  distances_m.push_back(reference.distance_m);
  angles_deg.push_back(deg_from_rad(reference.angle_rad));
  if (is_matched(scan)) squared_sigmas.push_back(squared_sigmas_of(scan));
}

}  // namespace

DriveFigures figures_of(const TrackedDrive& drive) {
  DriveFigures figures;
  StretchCounter stretches;
  std::vector<double> distances_m;
  std::vector<double> angles_deg;
  std::vector<double> squared_sigmas;
  for (const TrackedScan& scan : drive.scans) {
    ++figures.whereabouts[static_cast<std::size_t>(scan.pose.whereabouts)];
    figures.ambiguous += scan.pose.is_ambiguous ? 1U : 0U;
    figures.searches += scan.is_searched ? 1U : 0U;
    stretches.take(scan);
    if (scan.reference) compare(scan, figures, distances_m, angles_deg, squared_sigmas);
  }
  stretches.close();
  figures.stretches = std::move(stretches.stretches);
  figures.distance_m = summarise(distances_m);
  figures.angle_deg = summarise(angles_deg);
  figures.squared_sigmas = summarise(squared_sigmas);
  return figures;
}

StepTimes times_of(const TrackedDrive& drive, bool are_searched) {
  std::vector<double> wall_s;
  wall_s.reserve(drive.scans.size());
  for (const TrackedScan& scan : drive.scans) {
    if (scan.is_searched == are_searched) wall_s.push_back(scan.wall_s);
  }
  if (wall_s.empty()) return {};
  std::sort(wall_s.begin(), wall_s.end());
  return {.count = wall_s.size(),
          .median_s = quantile_of_sorted(wall_s, 0.5),
          .p99_s = quantile_of_sorted(wall_s, 0.99),
          .max_s = wall_s.back()};
}

std::string table_text(const TrackedDrive& drive) {
  std::string text =
      "scan,stamp_s,whereabouts,ambiguous,x_m,y_m,theta_rad,xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2,explained,"
      "mean_distance_m,reference_x_m,reference_y_m,reference_theta_rad,known_share\n";
  const auto out = std::back_inserter(text);
  for (const TrackedScan& scan : drive.scans) {
    const TrackedPose& pose = scan.pose;
    fmt::format_to(out, "{},{:.9f},{},{}", scan.index, scan.stamp_s, to_string(pose.whereabouts),
                   pose.is_ambiguous ? 1 : 0);
    if (pose.whereabouts == Whereabouts::kUnknown) {
      fmt::format_to(out, ",,,,,,,,,,,");
    } else {
      const Pose2& T = pose.T_map_base;
      const PoseCovariance& c = pose.covariance;
      fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4f},{:.5f}", T.x_m, T.y_m,
                     T.theta_rad, c.xx, c.xy, c.xt, c.yy, c.yt, c.tt, pose.explained, pose.mean_distance_m);
    }
    if (scan.reference) {
      const Pose2& T = scan.reference->T_map_base;
      fmt::format_to(out, ",{:.6f},{:.6f},{:.8f},{:.4f}\n", T.x_m, T.y_m, T.theta_rad, scan.reference->known_share);
    } else {
      fmt::format_to(out, ",,,,\n");
    }
  }
  return text;
}

}  // namespace gdtslam
