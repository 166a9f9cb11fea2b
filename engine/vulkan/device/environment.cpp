#include "environment.hpp"

#include <charconv>
#include <cstdlib>
#include <limits>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr const char* kFaultVariable = "GDTSLAM_VULKAN_FAULT";
constexpr const char* kSpinVariable = "GDTSLAM_VULKAN_SPIN_S";
constexpr const char* kValidationVariable = "GDTSLAM_VULKAN_VALIDATION";

struct FaultName {
  std::string_view name;
  VulkanFault::Code code;
};
constexpr FaultName kFaultNames[] = {{"device-lost", VulkanFault::Code::kDeviceLost},
                                     {"out-of-device-memory", VulkanFault::Code::kOutOfDeviceMemory},
                                     {"out-of-host-memory", VulkanFault::Code::kOutOfHostMemory}};

std::string_view read_variable(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

VulkanFault parse_fault(std::string_view text) {
  VulkanFault fault;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), fault.at);
  const auto digits = static_cast<std::size_t>(end - text.data());
  if (error == std::errc{} && fault.at > 0 && digits < text.size() && text[digits] == ':') {
    for (const FaultName& row : kFaultNames) {
      if (text.substr(digits + 1) == row.name) {
        fault.code = row.code;
        return fault;
      }
    }
  }
  throw UsageError(std::string(kFaultVariable) + "=" + std::string(text) +
                   ": write the number of the call, from 1, and device-lost, out-of-device-memory or "
                   "out-of-host-memory, as in 17:device-lost");
}

// Seconds of at least `least` and at most a day.
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
  const std::string_view fault = read_variable(kFaultVariable);
  if (options.fault.at == 0 && !fault.empty()) {
    options.fault = parse_fault(fault);
  }
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
