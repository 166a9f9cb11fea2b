#include "collect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "engine/core/files/folder_calls.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

bool drop_ending(std::string_view& name, std::span<const std::string_view> endings) {
  for (const std::string_view ending : endings) {
    if (!name.ends_with(ending) || name.size() == ending.size()) continue;
    name.remove_suffix(ending.size());
    return true;
  }
  return false;
}

// Where results are, there are tables that are no logs.
bool holds_results(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "report.json", ignored) || fs::exists(folder / kPlanFile, ignored);
}

std::uint64_t bytes_in(const fs::path& path) {
  std::error_code failed;
  std::uint64_t bytes = 0;
  if (fs::is_directory(path, failed)) {
    for (const fs::path& entry : list_folder(path, failed)) {
      if (fs::is_regular_file(entry, failed)) bytes += fs::file_size(entry, failed);
    }
  } else {
    bytes = fs::file_size(path, failed);
  }
  if (failed) throw FileError(path.string(), "cannot be read: " + failed.message());
  return bytes;
}

// Links stay as they are named, as other machines may know them; but what is above one is where it leads.
std::string absolute_path(const fs::path& path) {
  std::error_code failed;
  fs::path whole;
  for (const fs::path& part : fs::absolute(path, failed)) {
    if (part == "..") {
      std::error_code ignored;  // what is not there is no link
      if (fs::is_symlink(fs::symlink_status(whole, ignored))) whole = fs::canonical(whole, failed);
      whole = whole.parent_path();
    } else if (!part.empty() && part != ".") {
      whole /= part;
    }
  }
  if (failed) throw FileError(path.string(), "has no absolute path: " + failed.message());
  return whole.string();
}

// Links are counted that would have been logs, or folders to search: those may lead up again.
void search(const fs::path& folder, std::vector<fs::path>& logs, std::size_t& links) {
  std::error_code failed;
  for (const fs::path& entry : list_folder(folder, failed)) {
    std::error_code ignored;  // what cannot be asked about is neither
    const std::string name = entry.filename().string();
    if (name.starts_with('.')) continue;
    if (fs::is_symlink(fs::symlink_status(entry, ignored))) {
      if (has_name_of_a_log(name) || fs::is_directory(entry, ignored)) ++links;
      continue;
    }
    if (fs::is_directory(entry, ignored)) {
      if (is_ros2_bag(entry)) {
        logs.push_back(entry);
      } else if (!holds_results(entry)) {
        search(entry, logs, links);
      }
    } else if (fs::is_regular_file(entry, ignored) && has_name_of_a_log(name)) {
      logs.push_back(entry);
    }
  }
  if (failed) throw FileError(folder.string(), "cannot be read: " + failed.message());
}

std::uint64_t bytes_from(std::string_view text) {
  std::uint64_t bytes = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), bytes);
  if (code != std::errc{} || end != text.data() + text.size())
    throw InputError(in_quotes(text) + " is no number of bytes; a line is an URI, or an URI, a tab and its bytes");
  return bytes;
}

}  // namespace

bool is_ros2_bag(const std::filesystem::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "metadata.yaml", ignored);
}

bool has_name_of_a_log(std::string_view file) {
  static constexpr std::array<std::string_view, 4> kPacked{".gz", ".bz2", ".xz", ".zst"};
  static constexpr std::array<std::string_view, 7> kLogs{".log", ".clf", ".csv", ".jsonl", ".bag", ".mcap", ".db3"};
  drop_ending(file, kPacked);
  return drop_ending(file, kLogs);
}

void UnitCollector::add_unit(std::string uri, std::uint64_t bytes) {
  if (!is_utf8(uri)) throw InputError({uri, 0}, "is a name in no UTF-8, which a plan cannot hold; rename it");
  units_.push_back({std::move(uri), bytes});
}

void UnitCollector::add(const std::string& log) {
  if (has_scheme(log)) return add_unit(log, 0);
  std::error_code failed;
  const fs::file_status status = fs::status(log, failed);
  if (!fs::exists(status)) throw FileError(log, "cannot be read: " + errno_text(failed ? failed.value() : ENOENT));
  if (!fs::is_directory(status) && !fs::is_regular_file(status)) throw FileError(log, "is no plain file");
  if (!fs::is_directory(status) || is_ros2_bag(log)) return add_unit(absolute_path(log), bytes_in(log));
  if (holds_results(log))
    throw InputError({log, 0}, "holds results of gdtslam, whose tables are no logs; name the logs themselves");
  std::vector<fs::path> logs;
  search(log, logs, links_);
  if (logs.empty())
    throw InputError({log, 0}, fmt::format("holds no file that is named as a log; supported are {} logs", kLogFormats));
  for (const fs::path& found : logs) add_unit(absolute_path(found), bytes_in(found));
}

void UnitCollector::add_list(std::string_view text, const std::string& name) {
  std::uint64_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    const std::size_t tab = line.rfind('\t');
    try {
      if (tab == std::string_view::npos) {
        add(std::string(line));
      } else {
        const std::string uri(line.substr(0, tab));
        if (uri.empty())
          throw InputError("names no log before its tab; a line is an URI, or an URI, a tab and its bytes");
        std::error_code ignored;  // a log may be there on other machines alone
        if (!has_scheme(uri) && fs::is_directory(uri, ignored) && !is_ros2_bag(uri))
          throw InputError("is a folder and no ROS 2 bag; without its bytes it is searched for logs");
        add_unit(has_scheme(uri) ? uri : absolute_path(uri), bytes_from(line.substr(tab + 1)));
      }
    } catch (const InputError& error) {
      throw InputError({name, number}, error.what());
    } catch (const FileError& error) {
      throw FileError(fmt::format("{}:{}", name, number), error.what());
    }
  }
}

CollectedUnits UnitCollector::take() {
  std::vector<FleetUnit> units = std::move(units_);
  std::sort(units.begin(), units.end(),
            [](const FleetUnit& a, const FleetUnit& b) { return a.uri != b.uri ? a.uri < b.uri : a.bytes > b.bytes; });
  const std::size_t all = units.size();
  units.erase(
      std::unique(units.begin(), units.end(), [](const FleetUnit& a, const FleetUnit& b) { return a.uri == b.uri; }),
      units.end());
  const std::size_t twice = all - units.size();
  return {std::move(units), twice, links_};
}

}  // namespace gdtslam
