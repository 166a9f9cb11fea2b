#include <array>

#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {
namespace {

using namespace std::string_view_literals;

constexpr std::array kInterpolations{"linear"sv, "geodesic"sv, "odometry"sv};
constexpr std::array kForms{"working"sv, "literal"sv};

}  // namespace

std::vector<Option> options_of(NoddingConfig& config) {
  return {
      {"nod.horizontal", "scans whose elevations all lie within this of horizontal fix the pose", Unit::kRadian, 0.0001,
       0.2, &config.horizontal_rad},
      {"nod.interpolation", "poses between two fixes, equation (13): linear, geodesic, or odometry", Unit::kNone, 0, 0,
       Choice(config.interpolation, kInterpolations)},
      {"nod.form", "equation (14): working, or literal as printed, whose translation is scaled by the height",
       Unit::kNone, 0, 0, Choice(config.form, kForms)},
      {"nod.max_blind", "after this long without a horizontal scan poses come from the odometry alone", Unit::kSecond,
       0.1, 3600.0, &config.max_blind_s},
  };
}

}  // namespace gdtslam
