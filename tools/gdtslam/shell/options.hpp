// Command-line options that take a quantity with its unit (core/units.hpp; 0 needs none) or a count. Thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/units.hpp"
#include "tools/gdtslam/shell/cli.hpp"

namespace gdtslam {

/// Parses the text of an option as a quantity. Throws a UsageError that names the option.
double quantity_of(const std::string& option, const std::string& text, Unit unit);
/// "1,2,3" as its three words, which may be empty.
std::vector<std::string> words_between_commas(const std::string& text);

/// Limits of an option, both ends included.
struct QuantityBounds {
  double least = 0.0;
  double most = 0.0;
};

/// Adds an option that quantity_of parses and that must lie within the bounds. If the option is not given, `value`
/// keeps its default. Parsing throws UsageError.
CLI::Option* add_quantity_option(CLI::App& command, const std::string& name, double& value, Unit unit,
                                 const QuantityBounds& bounds, const std::string& doc);

// Options that are counts. CLI11 alone accepts "-1" as an unsigned number and wraps it, and reads "010" as 8.

/// Rewrites a whole number so that CLI11 reads it as decimal; other text stays unchanged.
CLI::Validator without_leading_zeros();

/// Accepts whole decimal numbers of at least `minimum` that fit 64 bits.
CLI::Validator whole_number_from(std::uint64_t minimum);

/// Adds an option that takes a count of at least `minimum`. Count is int, std::uint32_t or std::uint64_t.
template <class Count>
CLI::Option* add_count_option(CLI::App& command, const std::string& name, Count& count, std::uint64_t minimum,
                              const std::string& doc);

}  // namespace gdtslam
