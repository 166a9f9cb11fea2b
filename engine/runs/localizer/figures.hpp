// What localised scans add up to: the share that is right by the reference, and why the rest is not. Thread-safe; O(n
// log n).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "engine/runs/evaluation/errors.hpp"
#include "gdtslam/mapping/evaluation.hpp"
#include "run.hpp"
#include "scans.hpp"

namespace gdtslam {

/// Why a scan was not found where the reference has it.
enum class LocalizeFault : std::uint8_t {
  kNone,           ///< it was
  kTooFewReturns,  ///< nothing was searched
  kNoOverlap,      ///< at the reference less than half of its points lie near any obstacle of the map
  kNotProven,      ///< a search was cut short before it could tell
  kAsGood,         ///< both poses cost the same, up to the gap of the proof
  kMapPrefers,     ///< any pose near the reference costs more, by more than the gap
};
inline constexpr std::array kLocalizeFaults{LocalizeFault::kTooFewReturns, LocalizeFault::kNoOverlap,
                                            LocalizeFault::kNotProven, LocalizeFault::kAsGood,
                                            LocalizeFault::kMapPrefers};
/// For programs: "as-good".
std::string_view to_string(LocalizeFault fault);
/// For people: "both poses fit alike".
std::string_view as_text(LocalizeFault fault);

/// Of a scan with a reference.
LocalizeFault fault_of(const LocalizedScan& scan, const LocalizeLimits& limits);

struct LocalizeFigures {
  std::array<std::uint64_t, kVerdicts.size()> verdicts{};  ///< in the order of kVerdicts
  std::uint64_t certified = 0;                             ///< scans that are proven
  Share within;  ///< of the scans with a reference, those without enough returns among them
  std::array<std::uint64_t, kLocalizeFaults.size()> faults{};  ///< in the order of kLocalizeFaults
  ErrorSummary distance_m;                                     ///< of those within the limits
  ErrorSummary angle_deg;
};
LocalizeFigures figures_of(const std::vector<LocalizedScan>& scans, const LocalizeLimits& limits);

/// "196 found, 4 ambiguous, 0 poor fit"; scans without a pose where there are any.
std::string as_text(const decltype(LocalizeFigures::verdicts)& verdicts);

}  // namespace gdtslam
