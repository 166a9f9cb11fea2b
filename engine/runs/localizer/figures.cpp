#include "figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kLeastKnown = 0.5;

}  // namespace

std::string_view to_string(LocalizeFault fault) {
  static constexpr std::array<std::string_view, 6> kNames{"none",       "too-few-returns", "no-overlap",
                                                          "not-proven", "as-good",         "map-prefers"};
  static_assert(kNames.size() == kLocalizeFaults.size() + 1);  // kNone is not among them
  return kNames.at(static_cast<std::size_t>(fault));
}

std::string_view as_text(LocalizeFault fault) {
  static constexpr std::array<std::string_view, 6> kNames{"right",
                                                          "too few returns",
                                                          "the map has little of what the scan shows at the reference",
                                                          "the search was cut short",
                                                          "both poses fit alike",
                                                          "the map prefers the pose found"};
  static_assert(kNames.size() == kLocalizeFaults.size() + 1);
  return kNames.at(static_cast<std::size_t>(fault));
}

LocalizeFault fault_of(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.has_returns) return LocalizeFault::kTooFewReturns;
  const ReferencePose& reference = *scan.reference;
  if (reference.is_within) return LocalizeFault::kNone;
  if (reference.known_share < kLeastKnown) return LocalizeFault::kNoOverlap;
  if (!scan.best || !reference.nearby) return LocalizeFault::kNotProven;
  const double lead_m = reference.nearby->mean_cost_m - scan.best->mean_cost_m;
  if (lead_m < 0.0 && !scan.best->certified()) return LocalizeFault::kNotProven;
  return std::fabs(lead_m) <= limits.gap_m ? LocalizeFault::kAsGood : LocalizeFault::kMapPrefers;
}

std::string as_text(const decltype(LocalizeFigures::verdicts)& verdicts) {
  std::string text;
  for (const Verdict verdict : kVerdicts) {
    const std::uint64_t count = verdicts[static_cast<std::size_t>(verdict)];
    if (verdict == Verdict::kNoPose && count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, to_string(verdict));
  }
  return text;
}

LocalizeFigures figures_of(const std::vector<LocalizedScan>& scans, const LocalizeLimits& limits) {
  LocalizeFigures figures;
  std::vector<double> distances_m;
  std::vector<double> angles_deg;
  for (const LocalizedScan& scan : scans) {
    ++figures.verdicts[static_cast<std::size_t>(scan.verdict)];
    figures.certified += scan.is_proven() ? 1U : 0U;
    if (!scan.reference) continue;
    ++figures.within.of;
    const LocalizeFault fault = fault_of(scan, limits);
    if (fault == LocalizeFault::kNone) {
      ++figures.within.count;
      distances_m.push_back(scan.reference->distance_m);
      angles_deg.push_back(deg_from_rad(scan.reference->angle_rad));
      continue;
    }
    const auto* const place = std::find(kLocalizeFaults.begin(), kLocalizeFaults.end(), fault);
    ++figures.faults[static_cast<std::size_t>(place - kLocalizeFaults.begin())];
  }
  figures.distance_m = summarise(distances_m);
  figures.angle_deg = summarise(angles_deg);
  return figures;
}

}  // namespace gdtslam
