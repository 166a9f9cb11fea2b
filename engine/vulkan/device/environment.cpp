#include "environment.hpp"

#include <charconv>
#include <cstdlib>
#include <limits>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr const char* kSpinVariable = "GDTSLAM_VULKAN_SPIN_S";
constexpr const char* kValidationVariable = "GDTSLAM_VULKAN_VALIDATION";

std::string_view read_variable(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

// Parses seconds of at least `least` and at most a day.
double parse_seconds(const char* variable, std::string_view text, double least, const char* what) {
  double seconds = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, seconds);
  constexpr double kMost_s = 86400.0;
  if (error != std::errc{} || stop != end || !(seconds >= least && seconds <= kMost_s)) {
    throw UsageError(std::string(variable) + "=" + std::string(text) + ": write " + what);
  }
  return seconds;
}

double parse_wait(std::string_view text) {
  return parse_seconds(kWaitLimitVariable, text, std::numeric_limits<double>::min(),
                       "the most seconds that a wait for the device may take, more than 0 and at most 86400 (a day), "
                       "as in 120");
}

double parse_spin(std::string_view text) {
  return parse_seconds(kSpinVariable, text, 0.0,
                       "the seconds for which a wait asks before it sleeps, 0 to 86400, as in 5e-5");
}

}  // namespace

VulkanOptions with_environment(VulkanOptions options) {
  const std::string_view wait = read_variable(kWaitLimitVariable);
  if (!options.wait_limit_s && !wait.empty()) {
    options.wait_limit_s = parse_wait(wait);
  }
  const std::string_view spin = read_variable(kSpinVariable);
  if (!options.spin_s && !spin.empty()) {
    options.spin_s = parse_spin(spin);
  }
  const std::string_view validation = read_variable(kValidationVariable);
  if (validation == "1") {
    options.validation = true;
  } else if (!validation.empty() && validation != "0") {
    throw UsageError(std::string(kValidationVariable) + "=" + std::string(validation) + ": write 0 or 1");
  }
  return options;
}

}  // namespace gdtslam
