// A folder of its own below another one, else $TMPDIR or /tmp, that is gone with its object, with all that is in it.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

class TemporaryFolder {
 public:
  /// Throws FileError.
  explicit TemporaryFolder(const std::string& name, std::string below = "") {
    const char* const variable = std::getenv("TMPDIR");
    if (below.empty()) below = variable != nullptr && *variable != '\0' ? variable : "/tmp";
    path_ = below + "/" + name + "-XXXXXX";
    if (::mkdtemp(path_.data()) == nullptr) {
      throw FileError(path_, "cannot be created: " + std::generic_category().message(errno));
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;  // what cannot be removed is the system's to tidy up
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace gdtslam
