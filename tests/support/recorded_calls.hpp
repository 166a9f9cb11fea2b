// The calls by which a program puts files on the disk and gives them names, in their order: a test tells so that
// nothing takes its name before it is on the disk. The definitions here take the place of those of the C library in a
// program that uses this. Thread-safe.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gdtslam::test {

/// Records while it lives; one at a time.
class RecordedCalls {
 public:
  /// Of files below this folder; a name is what follows the folder, "." the folder itself.
  explicit RecordedCalls(const std::filesystem::path& folder);
  RecordedCalls(const RecordedCalls&) = delete;
  RecordedCalls& operator=(const RecordedCalls&) = delete;
  ~RecordedCalls();
  /// "sync NAME", "rename NAME to NAME" and "lock NAME", as they were made. The name of a temporary file and of a
  /// staging folder, which differ from run to run, is "~".
  [[nodiscard]] std::vector<std::string> all() const;
  /// Where the first of these is in all(); its size where there is none.
  [[nodiscard]] std::size_t place_of(const std::string& call) const;
};

}  // namespace gdtslam::test
