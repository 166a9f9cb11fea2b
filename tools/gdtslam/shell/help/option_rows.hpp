// The options of the settings as people read them: value, default, what is allowed, where the value comes from. Angles
// are in degrees; the exact values are those of `config show --yaml`.
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
  std::vector<std::string> choices;  ///< names that the value may be; empty for a number
  std::string exact_value;           ///< reads back as the same bits
  std::string exact_default;
  bool is_advanced = false;
};

/// In the order of the table. `file` is the configuration file that was read, if any.
std::vector<OptionRow> option_rows(Settings& settings, const std::string& file);

}  // namespace gdtslam
