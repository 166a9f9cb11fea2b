#include "written_files.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam {

void check_written_file(std::string_view option, const std::string& file, const std::vector<std::string>& inputs) {
  if (file.empty()) return;
  std::error_code error;  // what cannot be asked about is no input: reading it fails by itself
  for (const std::string& input : inputs) {
    if (!input.empty() && std::filesystem::equivalent(file, input, error)) {
      throw UsageError(fmt::format("{}: '{}' is what is read; give another file", option, file));
    }
  }
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const std::filesystem::file_status status = std::filesystem::status(folder, error);
  if (folder.empty() || std::filesystem::is_directory(status)) return;
  throw FileError(file, std::filesystem::exists(status) ? "cannot be created: Not a directory"
                                                        : "cannot be created: there is no folder " + folder.string());
}

}  // namespace gdtslam
