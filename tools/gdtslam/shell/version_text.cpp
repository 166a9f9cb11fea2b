#include "version_text.hpp"

#include <fmt/format.h>

#include <vector>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam {
namespace {

// Parts of the program that a build may be without.
std::string parts_of_build() {
  std::vector<std::string_view> parts;
  if (GDTSLAM_HAS_VULKAN) parts.emplace_back("Vulkan");
#ifdef GDTSLAM_HAS_VIEWER
  parts.emplace_back("viewer");
#endif
#ifdef GDTSLAM_HAS_SIM
  parts.emplace_back("simulator");
#endif
  return parts.empty() ? "no optional part" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string instruction_sets() {
  std::string text(to_string(best_isa()));
  text += " of ";
  for (std::size_t k = 0; k < kIsaCount; ++k) {
    text.append(k == 0 ? "" : ", ").append(to_string(static_cast<Isa>(k)));
  }
  return text;
}

}  // namespace

std::string version_text(const BuildStamp& build) {
  const std::string date = build.date.empty() ? std::string() : fmt::format(" of {}", build.date);
  return fmt::format(
      "gdtslam {}\n"
      "commit    {}{}\n"
      "built with {}\n"
      "computes  by the instruction set {}\n",
      GDTSLAM_VERSION, build.commit, date, parts_of_build(), instruction_sets());
}

}  // namespace gdtslam
