#include "tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace gdtslam::architecture {
namespace {

namespace fs = std::filesystem;

bool is_hidden_or_built(const std::string& name) {
  return name.starts_with('.') || name == "build" || name == "corpus" || name == "__pycache__";
}

}  // namespace

const fs::path& root() {
  static const fs::path path = GDTSLAM_SOURCE_DIR;
  return path;
}

std::string as_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<SourceFile> files_with(const std::vector<std::string>& folders, const std::set<std::string>& extensions) {
  std::vector<SourceFile> files;
  for (const std::string& folder : folders) {
    if (!fs::exists(root() / folder)) continue;
    for (auto at = fs::recursive_directory_iterator(root() / folder); at != fs::end(at); ++at) {
      if (at->is_directory() && is_hidden_or_built(at->path().filename().string())) {
        at.disable_recursion_pending();
      } else if (at->is_regular_file() && extensions.contains(at->path().extension().string())) {
        files.push_back({fs::relative(at->path(), root()).generic_string(), as_text(at->path())});
      }
    }
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return files;
}

const std::vector<SourceFile>& code() {
  static const std::vector<SourceFile> files =
      files_with({"engine", "calib", "viewer", "shaders", "tools", "examples", "tests"},
                 {".cpp", ".hpp", ".inl", ".comp", ".glsl"});
  return files;
}

void report(const SourceFile& file, const std::vector<Violation>& violations) {
  for (const Violation& violation : violations) {
    ADD_FAILURE() << file.path << ":" << violation.line << ": " << violation.message;
  }
}

}  // namespace gdtslam::architecture
