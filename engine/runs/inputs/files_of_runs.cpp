#include "files_of_runs.hpp"

#include <fmt/format.h>

#include <optional>
#include <system_error>

#include "engine/io/message_text.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "gdtslam/core/error.hpp"

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

bool is_run_file_in(const std::string& folder, const std::string& file) {
  const fs::path below = place_of_file(file).lexically_relative(place_of_file(folder));
  if (below.empty() || *below.begin() == ".." || *below.begin() == ".") return false;
  const std::string name = below.begin()->string();
  if (is_file_of_a_run(name)) return true;
  const std::optional<RunFiles> run = told_files_in(folder);
  return run && run->has(name);
}

void require_logs_elsewhere(const std::vector<std::string>& logs, const std::string& folder) {
  for (const std::string& log : logs) {
    if (log == "-" || !is_run_file_in(folder, log)) continue;
    throw UsageError(
        fmt::format("'{0}' is a file of the run folder that would be written; map it again with gdtslam map --continue "
                    "{1}, or give another folder",
                    one_line(log), one_line(folder)));
  }
}

}  // namespace gdtslam
