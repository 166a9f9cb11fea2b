// Lengths, angles and times of the command line: with their unit, or 0 (core/stated_quantity.hpp). Thread-safe.
#pragma once

#include <string>

#include "cli.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// The quantity that an option's text names. Throws UsageError that names the option.
double quantity_of(const std::string& option, const std::string& text, Unit unit);

/// What an option may be, both ends included.
struct QuantityBounds {
  double least = 0.0;
  double most = 0.0;
};

/// An option that is read by quantity_of and has to lie between the bounds. `value` keeps its default where the option
/// is not given; reading throws UsageError.
CLI::Option* add_quantity_option(CLI::App& command, const std::string& name, double& value, Unit unit,
                                 const QuantityBounds& bounds, const std::string& doc);

}  // namespace gdtslam
