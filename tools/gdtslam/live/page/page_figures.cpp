#include "page_figures.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using Figures = std::vector<std::pair<std::string, std::string>>;

void add_place(Figures& figures, const Pose2& T, const std::optional<PoseCovariance>& covariance) {
  figures.emplace_back("place", fmt::format("{:.2f}, {:.2f} m", T.x_m, T.y_m));
  figures.emplace_back("heading", fmt::format("{:.1f}°", deg_from_rad(wrap_angle(T.theta_rad))));
  if (!covariance) return;
  figures.emplace_back("deviation", fmt::format("{:.1f} cm, {:.2f}°", 100.0 * covariance->sigma_m(),
                                                deg_from_rad(std::sqrt(covariance->tt))));
}

Figures begun(const DriveCounts& counts, double stamp_s) {
  return {{"scans", fmt::format("{}", counts.scans)},
          {"rate", fmt::format("{:.1f} scans/s", counts.scans_per_s)},
          {"stamp", fmt::format("{:.2f} s", stamp_s)},
          {"path", fmt::format("{:.1f} m", counts.path_m)}};
}

}  // namespace

double RateMeter::count() {
  if (!is_begun_) since_ = Clock::now();
  is_begun_ = true;
  ++scans_;
  const double elapsed_s = std::chrono::duration<double>(Clock::now() - since_).count();
  if (elapsed_s < 1.0) return rate_;
  rate_ = static_cast<double>(scans_) / elapsed_s;
  scans_ = 0;
  since_ = Clock::now();
  return rate_;
}

ShownScan shown_scan(const DriveCounts& counts, const ScanConfig& valid, const MappedScan& mapped) {
  const MatchResult& match = mapped.match;
  ShownScan shown{.scan = counts.scans,
                  .laser = mapped.scan,
                  .valid = valid,
                  .T_map_base = mapped.T_closed_front * match.T_map_base,
                  .is_in_doubt = match.doubt != Doubt::kNone,
                  .figures = {}};
  shown.figures = [counts, match, T_map_base = *shown.T_map_base, T_closed_front = mapped.T_closed_front] {
    Figures figures = begun(counts, match.stamp_s);
    figures.emplace_back("keyframes", fmt::format("{}", counts.keyframes));
    add_place(figures, T_map_base, match.covariance);
    figures.emplace_back("doubt", std::string(to_string(match.doubt)));
    figures.emplace_back("mean distance", fmt::format("{:.1f} cm", 100.0 * match.mean_cost_m));
    figures.emplace_back("overlap", fmt::format("{:.0f} %", 100.0 * match.overlap));
    figures.emplace_back("contradiction", fmt::format("{:.0f} %", 100.0 * match.contradiction));
    figures.emplace_back("moved by loops", fmt::format("{:.2f} m, {:.1f}°", T_closed_front.translation().norm(),
                                                       deg_from_rad(wrap_angle(T_closed_front.theta_rad))));
    return figures;
  };
  return shown;
}

ShownScan shown_scan(const DriveCounts& counts, const ScanConfig& valid, const LaserScan& scan,
                     const TrackedPose& pose) {
  ShownScan shown{.scan = counts.scans,
                  .laser = scan,
                  .valid = valid,
                  .T_map_base = {},
                  .is_in_doubt = pose.whereabouts != Whereabouts::kTracked || pose.is_ambiguous,
                  .figures = {}};
  if (pose.whereabouts != Whereabouts::kUnknown) shown.T_map_base = pose.T_map_base;
  shown.figures = [counts, pose, stamp_s = scan.stamp_s] {
    Figures figures = begun(counts, stamp_s);
    if (pose.whereabouts != Whereabouts::kUnknown) {
      add_place(figures, pose.T_map_base, pose.covariance);
      figures.emplace_back("explained", fmt::format("{:.0f} %", 100.0 * pose.explained));
      figures.emplace_back("mean distance", fmt::format("{:.1f} cm", 100.0 * pose.mean_distance_m));
    }
    figures.emplace_back("doubt", std::string(to_string(pose.whereabouts)) + (pose.is_ambiguous ? ", ambiguous" : ""));
    return figures;
  };
  return shown;
}

}  // namespace gdtslam
