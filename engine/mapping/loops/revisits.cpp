#include "revisits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gdtslam {
namespace {

// Returns the nearest places first, one of each stretch of the path.
std::vector<Revisit> near_places(const PoseGraph& graph, std::span<const double> path_m, std::size_t here,
                                 const RevisitRules& rules, const std::vector<bool>& left_out) {
  std::vector<Revisit> all;
  for (std::size_t place = 0; place < here && path_m[here] - path_m[place] >= rules.least_path_m; ++place) {
    if (place < left_out.size() && left_out[place]) continue;
    const Pose2 T = between(graph.poses[place], graph.poses[here]);
    if (translation_length(T) <= rules.near_m + rules.widest_m) all.push_back({place, T, 0.0, 0.0});
  }
  std::stable_sort(all.begin(), all.end(), [](const Revisit& a, const Revisit& b) {
    return translation_length(a.T_place_here) < translation_length(b.T_place_here);
  });
  std::vector<Revisit> spread;
  for (const Revisit& revisit : all) {
    if (spread.size() == 2 * rules.most) break;
    const bool is_new = std::none_of(spread.begin(), spread.end(), [&](const Revisit& taken) {
      return std::fabs(path_m[taken.place] - path_m[revisit.place]) < rules.stretch_m;
    });
    if (is_new) spread.push_back(revisit);
  }
  return spread;
}

}  // namespace

double RevisitRules::half_m(const Revisit& revisit) const {
  return std::min(widest_m, sigmas * revisit.sigma_m + least_half_m);
}
double RevisitRules::half_rad(const Revisit& revisit) const {
  return std::min(std::numbers::pi, sigmas * revisit.sigma_rad + least_half_rad);
}

std::vector<Revisit> find_revisits(const PoseGraph& graph, const GraphCovariance& covariance,
                                   std::span<const double> path_m, std::size_t here, const RevisitRules& rules,
                                   const std::vector<bool>& left_out) {
  std::vector<Revisit> revisits = near_places(graph, path_m, here, rules, left_out);
  if (revisits.empty()) return revisits;
  const std::vector<Matrix3> of_here = covariance.column(here);
  for (Revisit& revisit : revisits) {
    const Matrix3 relative = covariance.relative(revisit.place, here, of_here);
    revisit.sigma_m = position_sigma(relative);
    revisit.sigma_rad = std::sqrt(std::max(0.0, relative(2, 2)));
  }
  std::erase_if(revisits, [&](const Revisit& revisit) {
    return translation_length(revisit.T_place_here) > rules.near_m + rules.half_m(revisit);
  });
  // Far and uncertain places cost much to search and are rarely found.
  const auto price = [&](const Revisit& revisit) {
    const double away_m = translation_length(revisit.T_place_here);
    return std::max(0.0, away_m - rules.half_m(revisit)) + 0.2 * away_m + 0.5 * rules.half_m(revisit);
  };
  std::stable_sort(revisits.begin(), revisits.end(),
                   [&](const Revisit& a, const Revisit& b) { return price(a) < price(b); });
  if (revisits.size() > rules.most) revisits.resize(rules.most);
  return revisits;
}

}  // namespace gdtslam
