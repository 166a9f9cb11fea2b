// Options of the command line that are quantities with their unit, or 0 (core/units.hpp), or counts.
// Thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/units.hpp"
#include "tools/gdtslam/shell/cli.hpp"

namespace gdtslam {

/// The quantity that an option's text names. Throws UsageError that names the option.
double quantity_of(const std::string& option, const std::string& text, Unit unit);

/// Limits of an option, both ends included.
struct QuantityBounds {
  double least = 0.0;
  double most = 0.0;
};

/// An option that is read by quantity_of and has to lie between the bounds. `value` keeps its default where the option
/// is not given; reading throws UsageError.
CLI::Option* add_quantity_option(CLI::App& command, const std::string& name, double& value, Unit unit,
                                 const QuantityBounds& bounds, const std::string& doc);

// Options that are counts. CLI11 alone takes "-1" for an unsigned number and wraps it, and reads "010" as 8.

/// Transforms a whole number into one that is read as decimal; what is none it leaves as it is.
CLI::Validator without_leading_zeros();

/// Accepts whole decimal numbers of at least `minimum` that fit 64 bits.
CLI::Validator whole_number_from(std::uint64_t minimum);

/// An option that is a count of at least `minimum`: int, std::uint32_t or std::uint64_t.
template <class Count>
CLI::Option* add_count_option(CLI::App& command, const std::string& name, Count& count, std::uint64_t minimum,
                              const std::string& doc);

}  // namespace gdtslam
