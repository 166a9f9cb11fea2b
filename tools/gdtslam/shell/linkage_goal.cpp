#include "linkage_goal.hpp"

#include <algorithm>
#include <cctype>

#include "quantity_option.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kBetween = "..";

bool has_unit(const std::string& text) {
  const auto last =
      std::find_if(text.rbegin(), text.rend(), [](unsigned char letter) { return std::isspace(letter) == 0; });
  return last != text.rend() && std::isdigit(static_cast<unsigned char>(*last)) == 0 && *last != '.';
}

// The unit of "5cm": what follows its last digit.
std::string unit_of(const std::string& text) {
  const std::size_t digit = text.find_last_of("0123456789.");
  return digit == std::string::npos ? "" : text.substr(digit + 1);
}

void read_crank(const std::string& text, calib::DesignGoal& goal) {
  const std::size_t between = text.find(kBetween);
  if (between == std::string::npos) {
    goal.least_crank_m = goal.most_crank_m = quantity_of("--crank", text, Unit::kMetre);
    return;
  }
  std::string least = text.substr(0, between);
  const std::string most = text.substr(between + kBetween.size());
  if (!has_unit(least)) {
    least += unit_of(most);
  }
  goal.least_crank_m = quantity_of("--crank", least, Unit::kMetre);
  goal.most_crank_m = quantity_of("--crank", most, Unit::kMetre);
}

}  // namespace

calib::DesignGoal goal_of(const GoalText& text) {
  calib::DesignGoal goal;
  if (!text.swing.empty()) {
    goal.swing_rad = quantity_of("--swing", text.swing, Unit::kRadian);
  }
  if (!text.min_transmission.empty()) {
    goal.min_transmission_rad = quantity_of("--min-transmission", text.min_transmission, Unit::kRadian);
  }
  if (!text.crank.empty()) {
    read_crank(text.crank, goal);
  }
  if (!text.time_ratio.empty()) {
    goal.time_ratio = quantity_of("--time-ratio", text.time_ratio, Unit::kNone);
  }
  if (!text.longest.empty()) {
    goal.longest_bar_m = quantity_of("--longest", text.longest, Unit::kMetre);
  }
  return goal;
}

}  // namespace gdtslam
