#include "loops_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "engine/core/quantile.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {

using Json = nlohmann::ordered_json;

std::vector<UncertainStretch> uncertain_stretches(std::span<const PoseCovariance> covariances) {
  std::vector<UncertainStretch> stretches;
  for (std::size_t i = 0; i < covariances.size(); ++i) {
    const double sigma_m = covariances[i].sigma_m();
    if (sigma_m <= kUncertain_m) continue;
    if (stretches.empty() || stretches.back().to + 1 < i) stretches.push_back({i, i, sigma_m});
    stretches.back().to = i;
    stretches.back().sigma_m = std::max(stretches.back().sigma_m, sigma_m);
  }
  return stretches;
}

std::string uncertain_line(std::span<const PoseCovariance> covariances) {
  const std::vector<UncertainStretch> stretches = uncertain_stretches(covariances);
  if (stretches.empty()) return "";
  std::size_t scans = 0;
  double sigma_m = 0.0;
  for (const UncertainStretch& stretch : stretches) {
    scans += stretch.to - stretch.from + 1;
    sigma_m = std::max(sigma_m, stretch.sigma_m);
  }
  return fmt::format(
      "not to be trusted: {} of {} scans in {} {}, standard deviation up to {:.2g} m; report.json has them\n", scans,
      covariances.size(), stretches.size(), stretches.size() == 1 ? "stretch" : "stretches", sigma_m);
}

Json loops_json(const ClosedPath& closed) {
  Json list = Json::array();
  std::size_t on = 0;
  for (const ClosedLoop& loop : closed.loops) {
    on += loop.is_on ? 1U : 0U;
    list.push_back({{"from", loop.from},
                    {"to", loop.to},
                    {"off_m", loop.off_m},
                    {"off_deg", deg_from_rad(loop.off_rad)},
                    {"weight", loop.weight},
                    {"on", loop.is_on}});
  }
  return {{"found", closed.loops.size()},
          {"on", on},
          {"searches", closed.searches},
          {"pruned", closed.pruned},
          {"pairs", closed.pairs},
          {"rms_m", closed.pairs > 0 ? Json(closed.rms_m) : Json(nullptr)},
          {"closures", list}};
}

Json wheels_json(const WheelReport& wheels) {
  return {{"distance", wheels.distance},
          {"distance_sigma", wheels.sigma_distance},
          {"turn", wheels.turn},
          {"turn_sigma", wheels.sigma_turn},
          {"turn_deg_per_m", deg_from_rad(wheels.turn_rad_per_m)},
          {"turn_deg_per_m_sigma", deg_from_rad(wheels.sigma_rad_per_m)},
          {"variance_factor", wheels.variance_factor},
          {"variance_factor_of_matches", wheels.variance_factor_of_matches}};
}

Json uncertain_json(const ClosedPath& closed, const Trajectory& trajectory) {
  Json list = Json::array();
  std::size_t scans = 0;
  for (const UncertainStretch& stretch : uncertain_stretches(closed.covariances)) {
    scans += stretch.to - stretch.from + 1;
    list.push_back({{"from", stretch.from},
                    {"to", stretch.to},
                    {"from_s", trajectory[stretch.from].stamp_s},
                    {"to_s", trajectory[stretch.to].stamp_s},
                    {"sigma_m", stretch.sigma_m}});
  }
  std::vector<double> sigmas_m;
  for (const PoseCovariance& covariance : closed.covariances) sigmas_m.push_back(covariance.sigma_m());
  std::sort(sigmas_m.begin(), sigmas_m.end());
  return {{"above_m", kUncertain_m},
          {"sigma_median_m", quantile_of_sorted(sigmas_m, 0.5)},
          {"sigma_max_m", sigmas_m.back()},
          {"scans", scans},
          {"stretches", list}};
}

}  // namespace gdtslam
