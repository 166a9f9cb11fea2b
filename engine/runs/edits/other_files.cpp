#include "other_files.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/runs/edits/map_picture_file.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// A link may lead to what is large, or of somebody else.
bool leads_out(const fs::path& run, const fs::path& file) {
  std::error_code failed;
  if (!fs::is_symlink(fs::symlink_status(file, failed))) return false;
  const fs::path inside = fs::canonical(run, failed);
  if (failed) return true;
  const fs::path target = fs::canonical(file, failed).lexically_relative(inside);
  return failed || target.empty() || *target.begin() == "..";
}

// What an earlier edit copied there, and nobody changed since, is replaced.
bool is_free(const RunFolder& folder, const std::optional<RunFiles>& earlier, const std::string& name) {
  return !lies_there(folder.file(name)) || (earlier && earlier->is_as_told(name));
}

}  // namespace

std::vector<std::string> other_files_in(const std::string& run, bool with_map_picture) {
  std::vector<std::string> names;
  std::error_code failed;
  for (const fs::path& entry : list_folder(run, failed)) {
    std::string name = entry.filename().string();
    if (is_file_of_a_run(name) || name.starts_with('.')) continue;
    if (with_map_picture && is_map_for_gis(name)) continue;
    names.push_back(std::move(name));
  }
  if (failed) throw FileError(run, "cannot be listed: " + failed.message());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> copy_other_files(const std::string& run, const std::vector<std::string>& names,
                                          RunFolder& folder, const std::function<void()>& before_piece) {
  std::vector<std::string> copied;
  const bool has_run = RunReader::is_gdtslam_run(folder.path());
  const std::optional<RunFiles> earlier = has_run ? told_files_in(folder.path()) : std::nullopt;
  for (const std::string& name : names) {
    const fs::path from = fs::path(run) / name;
    std::error_code ignored;
    if (!fs::is_regular_file(from, ignored) || leads_out(run, from) || !is_free(folder, earlier, name)) continue;
    copy_file_atomically(from.string(), folder.staged(name), before_piece);
    copied.push_back(name);
  }
  return copied;
}

}  // namespace gdtslam
