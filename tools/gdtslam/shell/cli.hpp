// Forward declarations of CLI11 for headers. CLI11's header adds a second to a compilation, and the inline constructor
// of CLI::App three more. Sources that define options include <CLI/App.hpp>; one place calls the constructor.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class App;
class Option;  // NOLINT(bugprone-forward-declaration-namespace): not gdtslam's
class Validator;
}  // namespace CLI

namespace gdtslam {

/// Adds a sub-command to `parent`.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& description);

}  // namespace gdtslam
