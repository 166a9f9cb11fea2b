#include "files_of_runs.hpp"

#include <optional>
#include <system_error>

#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// weakly_canonical() leaves a link alone whose file is not there yet, and the file would be made behind it.
fs::path behind_links(fs::path file) {
  constexpr int kMostLinks = 40;  // as the system follows
  std::error_code failed;
  for (int k = 0; k < kMostLinks && fs::is_symlink(fs::symlink_status(file, failed)); ++k) {
    const fs::path target = fs::read_symlink(file, failed);
    if (failed) break;
    file = file.parent_path() / target;
  }
  return file;
}

}  // namespace

fs::path place_of_file(const std::string& file) {
  std::error_code failed;
  const fs::path named = fs::absolute(file, failed);
  if (failed) return file;
  const fs::path place = fs::weakly_canonical(behind_links(named), failed);
  if (failed) return named.lexically_normal();
  return place.has_filename() ? place : place.parent_path();  // a slash at the end names the same
}

bool lies_in(const std::string& folder, const std::string& file) {
  const fs::path below = place_of_file(file).lexically_relative(place_of_file(folder));
  return !below.empty() && *below.begin() != ".." && *below.begin() != ".";
}

bool is_run_file_in(const std::string& folder, const std::string& file) {
  if (!lies_in(folder, file)) return false;
  const std::string name = place_of_file(file).lexically_relative(place_of_file(folder)).begin()->string();
  if (is_file_of_a_run(name)) return true;
  const std::optional<RunFiles> run = told_files_in(folder);
  return run && run->has(name);
}

}  // namespace gdtslam
