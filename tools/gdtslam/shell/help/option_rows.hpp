// The options of the settings in readable form: value, default, allowed values, origin of the value. Angles are in
// degrees; `config show --yaml` prints the exact values.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/runs/settings.hpp"

namespace gdtslam {

struct OptionRow {
  std::string path;
  std::string value;
  std::string default_value;
  std::string allowed;               ///< "0.005 m to 1 m", "true or false", "exact, jump-flood"
  std::string origin;                ///< "--set", the file, "default"
  std::string doc;                   ///< a sentence without its full stop
  std::vector<std::string> choices;  ///< allowed names; empty for a number
  std::string exact_value;           ///< parses back to the same bits
  std::string exact_default;
  bool is_advanced = false;
};

/// In the table's order. `file` is the configuration file that was read, or empty.
std::vector<OptionRow> option_rows(Settings& settings, const std::string& file);

}  // namespace gdtslam
