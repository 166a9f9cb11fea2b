// The rule for every output of every command: existing files stay unless --force is given, and no output is an input.
// The check comes before the work, so a run of minutes does not end with "cannot be created". One object belongs to one
// thread; cost: a few system calls for each file.
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
  /// Files and folders that the command reads; empty names, standard input and missing files are ignored. A YAML file
  /// stands also for the files that it names; a run, a ROS 2 bag or a file of a run for all of its files.
  WrittenFiles(const std::vector<std::string>& inputs, bool force);

  /// Registers a folder that the command writes a run into: no other output may be one of its files.
  void add_run(const std::string& folder) { written_runs_.push_back(folder); }
  /// Registers a folder that is replaced only with --force: throws UsageError if it is not empty and force is off.
  void add_folder(std::string_view option, const std::string& folder);

  /// Does nothing if `file` is empty or standard output. Throws UsageError that names the option if `file` exists and
  /// force is off, or if it is a folder, an input, another output (under any name) or a file of a run; FileError if its
  /// folder does not exist.
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
  std::vector<std::string> files_;    ///< the command's inputs
  std::vector<std::string> folders_;  ///< the command's inputs
  std::vector<std::string> written_runs_;
  std::vector<Written> written_;
};

}  // namespace gdtslam
