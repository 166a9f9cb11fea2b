// Configurations as YAML and from the command line, by a table of options (mapping/config.hpp): sections and names are
// the paths of the table, values carry units ("5 cm", "2 deg"), `version: 1` is the format's version. On any fault
// nothing is changed, and one ConfigError names every fault with file, line, path, value and bound, and the nearest
// name for a misspelt one. Thread-safe for tables that no two threads share; O(text).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/core/option.hpp"

namespace gdtslam {

/// Reads a file into the table's values; returns the paths that it set. "-" is standard input.
std::vector<std::string> read_config(const std::string& path, std::span<const Option> options);
/// The same from text; `name` is for messages.
std::vector<std::string> read_config_text(std::string_view text, const std::string& name,
                                          std::span<const Option> options);

/// `path=value` of a command line. Returns the path.
std::string set_option(std::span<const Option> options, std::string_view assignment);

/// The value as text with its unit, as read_config reads it.
std::string value_text(const Option& option);

/// The whole table as YAML, each value under its documentation; reads back as the same bits.
std::string config_text(std::span<const Option> options);

/// JSON schema (draft 2020-12) of the files for read_config.
std::string config_schema(std::span<const Option> options);

}  // namespace gdtslam
