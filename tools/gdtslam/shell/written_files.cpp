#include "written_files.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <fstream>
#include <iterator>
#include <system_error>

#include "engine/io/referenced_file.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

std::string begin_of_file(const std::string& file) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;  // size limit of map and scene descriptions
  std::string text(kMostBytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

// First word without quotation marks; after the colon if there is a key, as in "linkage: 'a.yaml', rate: 2".
std::string first_word(std::string_view text) {
  constexpr std::string_view kAround = " \t\"'";
  text = text.substr(0, text.find_first_of(",}]#\r"));
  const std::size_t begin = text.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  return std::string(text.substr(begin, text.find_last_not_of(kAround) + 1 - begin));
}

// Files that a map.yaml, gdt.yaml or scene reads. A name in a comment counts too, which only forbids it as an output.
std::vector<std::string> files_named_in(const std::string& yaml) {
  std::vector<std::string> files;
  const std::string text = begin_of_file(yaml);
  for (const std::string_view key : {"image:", "file:", "linkage:"}) {
    for (std::size_t at = text.find(key); at != std::string::npos; at = text.find(key, at + key.size())) {
      const std::size_t begin = at + key.size();
      const std::string name = first_word(std::string_view(text).substr(begin, text.find('\n', begin) - begin));
      if (!name.empty()) files.push_back(referenced_path(yaml, name));
    }
  }
  return files;
}

// Follows the reader of a ROS 2 bag: the files that metadata.yaml names, else all with these endings.
bool is_bag_file_in(const std::string& folder, const std::string& file) {
  const fs::path place = place_of_file(file);
  if (place.parent_path() != place_of_file(folder)) return false;
  const std::string name = place.filename().string();
  if (name == "metadata.yaml") return true;
  const std::string metadata = (fs::path(folder) / "metadata.yaml").string();
  std::error_code ignored;
  if (fs::is_regular_file(metadata, ignored)) return begin_of_file(metadata).find(name) != std::string::npos;
  const std::string ending = extension_of(name);
  return ending == ".db3" || ending == ".mcap" || ending == ".zstd";
}

// A pipe or a device is written to; nothing is replaced.
bool is_replaced(const std::string& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  return !fs::exists(status) || fs::is_regular_file(status) || fs::is_directory(status);
}

[[noreturn]] void refuse_existing(std::string_view option, const std::string& path) {
  throw UsageError(fmt::format("{}: '{}' exists; give another name, or --force to replace it", option, path));
}

void require_parent_folder(const std::string& file) {
  std::error_code ignored;
  const fs::path folder = fs::path(file).parent_path();
  const fs::file_status status = fs::status(folder, ignored);
  if (folder.empty() || fs::is_directory(status)) return;
  throw FileError(file, fs::exists(status) ? "cannot be created: Not a directory"
                                           : "cannot be created: there is no folder " + folder.string());
}

}  // namespace

void add_force_option(CLI::App& command, bool& force) {
  command.add_flag("--force", force, "Replace outputs that exist; without it they are refused");
}

WrittenFiles::WrittenFiles(const std::vector<std::string>& inputs, bool force) : force_(force) {
  std::error_code ignored;  // a file without a status is no input: reading it fails by itself
  for (const std::string& input : inputs) {
    if (input.empty() || input == "-") continue;
    const fs::file_status status = fs::status(input, ignored);
    if (fs::is_directory(status)) folders_.push_back(input);
    if (!fs::exists(status) || fs::is_directory(status)) continue;
    files_.push_back(input);
    const std::string folder = place_of_file(input).parent_path().string();
    if (RunReader::is_run(folder) && is_run_file_in(folder, input)) folders_.push_back(folder);
    const std::string ending = extension_of(input);
    if (!fs::is_regular_file(status) || (ending != ".yaml" && ending != ".yml")) continue;
    for (std::string& named : files_named_in(input)) files_.push_back(std::move(named));
  }
}

void WrittenFiles::add_folder(std::string_view option, const std::string& folder) {
  if (folder.empty()) return;
  add_run(folder);
  std::error_code ignored;  // an unreadable or misplaced folder fails by itself
  if (!force_ && fs::is_directory(folder, ignored) && !fs::is_empty(folder, ignored)) refuse_existing(option, folder);
}

void WrittenFiles::add(std::string_view option, const std::string& file) {
  if (file.empty() || file == "-") return;
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) {
    throw UsageError(fmt::format("{}: '{}' is a folder; give the name of a file", option, file));
  }
  if (is_replaced(file)) require_replaceable(option, file);
  require_parent_folder(file);
}

void WrittenFiles::require_replaceable(std::string_view option, const std::string& file) {
  require_not_read(option, file);
  require_not_of_a_run(option, file);
  require_once(option, file);
  std::error_code ignored;
  if (!force_ && fs::exists(file, ignored)) refuse_existing(option, file);
}

void WrittenFiles::require_not_read(std::string_view option, const std::string& file) const {
  const fs::path place = place_of_file(file);
  std::error_code ignored;
  for (const std::vector<std::string>* const inputs : {&files_, &folders_}) {
    for (const std::string& input : *inputs) {
      if (place != place_of_file(input) && !fs::equivalent(file, input, ignored)) continue;
      throw UsageError(fmt::format("{}: '{}' is what is read; give another file", option, file));
    }
  }
  for (const std::string& folder : folders_) {
    if (!is_run_file_in(folder, file) && !is_bag_file_in(folder, file)) continue;
    throw UsageError(fmt::format("{}: '{}' is a file of '{}', which is read; give another file", option, file, folder));
  }
}

void WrittenFiles::require_not_of_a_run(std::string_view option, const std::string& file) const {
  for (const std::string& folder : written_runs_) {
    if (!is_run_file_in(folder, file)) continue;
    throw UsageError(fmt::format("{}: '{}' is a file of the run in '{}', which is written; give another file", option,
                                 file, folder));
  }
  const std::string folder = place_of_file(file).parent_path().string();
  if (!RunReader::is_gdtslam_run(folder) || !is_run_file_in(folder, file)) return;
  throw UsageError(fmt::format("{}: '{}' is a file of the run in '{}', which would be damaged; give another file",
                               option, file, folder));
}

void WrittenFiles::require_once(std::string_view option, const std::string& file) {
  const fs::path place = place_of_file(file);
  for (const Written& other : written_) {
    if (other.place != place) continue;
    throw UsageError(fmt::format("{}: '{}' is what {} writes; give another file", option, file, other.option));
  }
  written_.push_back({std::string(option), place});
}

}  // namespace gdtslam
