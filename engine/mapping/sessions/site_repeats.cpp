#include "site_repeats.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/mapping/adjust/pose_bins.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/certified.hpp"

namespace gdtslam {
namespace {

constexpr double kApart_m = 1.5;  // of places of a site that are looked for
constexpr double kApart_rad = 0.8;
constexpr double kSpot_m = 2.0;                 // around where one fits as well
constexpr std::size_t kLeastFitting = 2;        // places of a session at the other spot,
constexpr std::size_t kFittingOverAgainst = 2;  // so many for each that does not fit there

// One for each spot and direction.
std::vector<std::size_t> places_apart(const Session& site) {
  std::vector<std::size_t> apart;
  for (const std::size_t place : site.places) {
    const Pose2& pose = site.poses[place];
    const bool is_known = std::any_of(apart.begin(), apart.end(), [&](std::size_t other) {
      return squared_distance(site.poses[other], pose) < kApart_m * kApart_m &&
             std::fabs(wrap_angle(site.poses[other].theta_rad - pose.theta_rad)) < kApart_rad;
    });
    if (!is_known) apart.push_back(place);
  }
  return apart;
}

}  // namespace

SiteRepeats::SiteRepeats(const Session& site, const SessionMap& map, WorkerPool& workers) : site_(site), map_(map) {
  const std::vector<std::size_t> places = places_apart(site);
  std::vector<std::optional<Pose2>> found(places.size());
  workers.run(places.size(), 1, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t k = begin; k < end; ++k) {
      found[k] = map.find_elsewhere(site, places[k], site.poses[places[k]]);
    }
  });
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (found[k]) repeats_.push_back({places[k], *found[k]});
  }
}

// Those that a spot of it speaks for which is there twice.
std::vector<Pose2> SiteRepeats::other_ways(const Session& query, const Pose2& T_site_query) const {
  std::vector<Pose2> ways;
  for (const std::size_t place : query.places) {
    const Pose2 here = T_site_query * query.poses[place];
    for (const Repeat& repeat : repeats_) {
      if (squared_distance(repeat.T_site_there, here) > kSpot_m * kSpot_m) continue;
      const Pose2 way = site_.poses[repeat.keyframe] * between(repeat.T_site_there, T_site_query);
      const bool is_known = std::any_of(ways.begin(), ways.end(), [&](const Pose2& known) {
        return ExcludedPoses{known * query.poses[place]}.hold(way * query.poses[place]);
      });
      if (!is_known) ways.push_back(way);
    }
  }
  return ways;
}

bool SiteRepeats::is_way(const Session& query, const Pose2& T_site_query) const {
  std::size_t fitting = 0;
  std::size_t against = 0;
  for (const std::size_t place : query.places) {
    switch (map_.test_walls(query, place, T_site_query * query.poses[place])) {
      case SessionMap::Test::kElsewhere:
        break;
      case SessionMap::Test::kFits:
        ++fitting;
        break;
      case SessionMap::Test::kDoesNotFit:
        ++against;
        break;
    }
  }
  return fitting >= kLeastFitting && fitting >= kFittingOverAgainst * against &&
         !map_.has_walls_in_the_way(query, T_site_query);
}

bool SiteRepeats::may_lie_elsewhere(const Session& query, const Pose2& T_site_query) const {
  const std::vector<Pose2> ways = other_ways(query, T_site_query);
  return std::any_of(ways.begin(), ways.end(), [&](const Pose2& way) { return is_way(query, way); });
}

}  // namespace gdtslam
