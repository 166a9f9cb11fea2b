// The files that a command is told to write, checked before its work begins: a run of minutes should not end with
// "cannot be created", and none may replace what the command reads or what it writes besides. One object belongs to one
// thread; a few calls of the system for each file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

class WrittenFiles {
 public:
  /// Only a log may replace a recording.
  enum class Kind : std::uint8_t { kResult, kLog };

  /// Files and folders that the command reads; an empty name, standard input and what is not there count for nothing.
  /// Of a YAML file also those that it names, of a run or a ROS 2 bag, or a file of a run, all of its own files.
  explicit WrittenFiles(const std::vector<std::string>& inputs);

  /// The command writes a run into that folder, too.
  void add_run(const std::string& folder) { written_runs_.push_back(folder); }

  /// Nothing where `file` is empty. Throws UsageError that names the option where `file` is one that is read, or
  /// written already, under whatever name, a file of a run, or where a recording lies that it would replace; FileError
  /// where its folder does not exist.
  void add(std::string_view option, const std::string& file, Kind kind = Kind::kResult);

 private:
  struct Written {
    std::string option;
    std::filesystem::path place;
  };
  void require_replaceable(std::string_view option, const std::string& file, Kind kind);
  void require_not_read(std::string_view option, const std::string& file) const;
  void require_not_of_a_run(std::string_view option, const std::string& file) const;
  void require_once(std::string_view option, const std::string& file);

  std::vector<std::string> files_;    ///< that are read
  std::vector<std::string> folders_;  ///< likewise
  std::vector<std::string> written_runs_;
  std::vector<Written> written_;
};

}  // namespace gdtslam
