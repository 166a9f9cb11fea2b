#include "site_places.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>

#include "engine/core/files/folder_calls.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFirstSession = "session-1.tum";  // every site has it, and no run of `map`

[[noreturn]] void refuse_place(const fs::path& place, const char* fault) {
  throw UsageError(fmt::format("--output: '{}' {}", place.string(), fault));
}

// 0 where the name is not the number of a site.
std::size_t site_number(const fs::path& place) {
  const std::string name = place.filename().string();
  std::size_t number = 0;
  const std::from_chars_result read = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool is_number = read.ec == std::errc{} && read.ptr == name.data() + name.size() && !name.starts_with('0');
  return is_number ? number : 0;
}

// By device and inode, whatever links lead there.
void require_none_of(std::span<const std::string> runs, const fs::path& place) {
  const auto is_place = [&](const std::string& run) {
    std::error_code ignored;  // what is not there is told of where it is read
    return fs::equivalent(run, place, ignored);
  };
  if (std::any_of(runs.begin(), runs.end(), is_place)) {
    refuse_place(place, "is a run to be joined, which would be replaced; give another folder");
  }
}

// But for what a killed process left. What cannot be listed shows when it cannot be written.
bool is_empty_place(const fs::path& folder) {
  std::error_code ignored;
  const std::vector<fs::path> files = list_folder(folder, ignored);
  return std::all_of(files.begin(), files.end(), [](const fs::path& file) {
    const std::string name = file.filename().string();
    return name.starts_with('.') && is_file_of_a_run(name);
  });
}

void require_place(const fs::path& place, bool replaces_foreign) {
  if (!lies_there(place)) return;
  std::error_code ignored;
  const fs::file_status status = fs::symlink_status(place, ignored);
  if (fs::is_symlink(status)) refuse_place(place, "is a link, and what it leads to no site; give another folder");
  if (!fs::is_directory(status)) refuse_place(place, "is no folder, and a site would have its name");
  if (replaces_foreign) return;
  std::vector<std::string> names = names_of_changes();
  names.emplace_back(kFirstSession);
  require_no_foreign_files(place.string(), names);
  if (is_site(place.string())) return;
  if (RunReader::is_run(place.string())) {
    refuse_place(place, "is a run that no merge wrote; give another folder, or --force to replace it");
  }
  if (is_empty_place(place) || unfinished_run_in(place.string(), kReportFile).is_of_a_commit) return;
  refuse_place(place, "holds files and is no site of a merge; give another folder, or --force to write there");
}

}  // namespace

std::vector<std::string> names_of_changes() { return {"changes.png", "changes.svg"}; }

bool is_site(const std::string& folder) {
  std::error_code ignored;
  if (!fs::is_directory(fs::symlink_status(folder, ignored)) || !RunReader::is_gdtslam_run(folder)) return false;
  const std::optional<RunFiles> run = told_files_in(folder);
  return run && run->has(kFirstSession) && !run->report().has("edited");
}

std::vector<std::string> sites_beyond(const std::string& folder, std::size_t sites) {
  std::vector<std::string> beyond;
  std::error_code ignored;  // what cannot be listed cannot be written to either
  for (const fs::path& place : list_folder(folder, ignored)) {
    if (site_number(place) > sites && is_site(place.string())) beyond.push_back(place.string());
  }
  std::sort(beyond.begin(), beyond.end());
  return beyond;
}

void require_places_of_sites(const std::string& folder, std::span<const std::string> runs, bool replaces_foreign) {
  require_none_of(runs, folder);
  std::error_code ignored;
  for (const fs::path& place : list_folder(folder, ignored)) {
    if (site_number(place) > 0) require_none_of(runs, place);
  }
  for (std::size_t k = 1; k <= runs.size(); ++k) {
    require_place(fs::path(folder) / std::to_string(k), replaces_foreign);
  }
}

}  // namespace gdtslam
