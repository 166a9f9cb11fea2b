// The files of the project, read once, for the rules that hold for all of them.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "source_rules.hpp"

namespace gdtslam::architecture {

struct SourceFile {
  std::string path;  ///< relative to the project
  std::string text;
};

/// The project's folder.
const std::filesystem::path& root();
std::string as_text(const std::filesystem::path& file);

/// Every file of the folders with one of the extensions, in the order of the paths.
std::vector<SourceFile> files_with(const std::vector<std::string>& folders, const std::set<std::string>& extensions);
/// Every source of the project.
const std::vector<SourceFile>& code();

/// Fails the test for each violation.
void report(const SourceFile& file, const std::vector<Violation>& violations);

}  // namespace gdtslam::architecture
