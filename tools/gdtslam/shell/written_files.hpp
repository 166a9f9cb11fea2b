// The one rule for every output of every command: what exists stays unless --force, and no output is an input. It is
// checked before the work begins: a run of minutes should not end with "cannot be created". One object belongs to one
// thread; a few calls of the system for each file.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "cli.hpp"

namespace gdtslam {

/// Adds --force, the only way to replace what exists.
void add_force_option(CLI::App& command, bool& force);

class WrittenFiles {
 public:
  /// Files and folders that the command reads; an empty name, standard input and what is not there count for nothing.
  /// A YAML file also stands for the files that it names; a run, a ROS 2 bag or a file of a run for all of its files.
  WrittenFiles(const std::vector<std::string>& inputs, bool force);

  /// The command writes a run into that folder, too: none of its files is another output.
  void add_run(const std::string& folder) { written_runs_.push_back(folder); }
  /// Does the same for a folder that --force alone replaces: throws UsageError if it holds anything and force is off.
  void add_folder(std::string_view option, const std::string& folder);

  /// Does nothing if `file` is empty or standard output. Throws UsageError that names the option if `file` exists and
  /// force is off, if it is a folder, an input, another output (under whatever name) or a file of a run; FileError if
  /// its folder does not exist.
  void add(std::string_view option, const std::string& file);

 private:
  struct Written {
    std::string option;
    std::filesystem::path place;
  };
  void require_replaceable(std::string_view option, const std::string& file);
  void require_not_read(std::string_view option, const std::string& file) const;
  void require_not_of_a_run(std::string_view option, const std::string& file) const;
  void require_once(std::string_view option, const std::string& file);

  bool force_;
  std::vector<std::string> files_;    ///< inputs
  std::vector<std::string> folders_;  ///< inputs
  std::vector<std::string> written_runs_;
  std::vector<Written> written_;
};

}  // namespace gdtslam
