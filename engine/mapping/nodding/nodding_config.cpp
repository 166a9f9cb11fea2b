#include <array>

#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {
namespace {

using namespace std::string_view_literals;

constexpr std::array kInterpolations{"linear"sv, "geodesic"sv, "odometry"sv};
constexpr std::array kForms{"working"sv, "literal"sv};

}  // namespace

MapperConfig mapper_config_of(MapperConfig config, const NoddingConfig& nodding) {
  config.prior.limit_sigmas = nodding.prior_limit_sigmas;
  return config;
}

std::vector<Option> option_table(NoddingConfig& config) {
  return {
      {"nod.horizontal", "scans whose elevations all lie within this of horizontal fix the pose", Unit::kRadian, 0.0001,
       0.2, &config.horizontal_rad},
      {"nod.interpolation", "poses between two fixes, equation (13): linear, geodesic, or odometry", Unit::kNone, 0, 0,
       Choice(config.interpolation, kInterpolations)},
      {"nod.form", "equation (14): working, or literal as printed, whose translation is scaled by the height",
       Unit::kNone, 0, 0, Choice(config.form, kForms)},
      {"nod.smooth",
       "between two fixes, where poses follow the odometry, points at the height of walls help to place the robot",
       Unit::kNone, 0, 1, &config.smoother.is_on},
      {"nod.band_up", "such points lie at most this much higher than the map", Unit::kMetre, 0.0, 100.0,
       &config.smoother.band_up_m},
      {"nod.band_floor", "and at least this much above the floor", Unit::kMetre, -100.0, 100.0,
       &config.smoother.above_floor_m},
      {"nod.prior_limit",
       "takes the place of prior.limit: metres lie between two fixes, and what looks alike far away is no match",
       Unit::kNone, 0.1, 1000.0, &config.prior_limit_sigmas},
      {"nod.max_blind", "after this long without a horizontal scan poses come from the odometry alone", Unit::kSecond,
       0.1, 3600.0, &config.max_blind_s},
  };
}

}  // namespace gdtslam
