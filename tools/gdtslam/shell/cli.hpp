// Declarations of CLI11 for headers. Its own header costs a source a second, and CLI::App's constructor, which is
// inline, three more: sources that define options include <CLI/App.hpp>, and the constructor is called in one place.
#pragma once

#include <string>

namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class App;
class Option;  // NOLINT(bugprone-forward-declaration-namespace): not gdtslam's
class Validator;
}  // namespace CLI

namespace gdtslam {

/// A new sub-command of `parent`.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& description);

}  // namespace gdtslam
