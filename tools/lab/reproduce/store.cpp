#include "store.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/files/retried.hpp"
#include "engine/drawing/markup.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::reproduce {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Row, quantity, paper, ours, verdict, remark)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Picture, file, caption, across)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Table, caption, heads, rows)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Part, origin, source, pictures, rows, tables, notes, by_hand)

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kVersion = 2;
constexpr const char* kMaking = ".making";

Json as_json(const std::string& key, const KeptPart& kept) {
  Json json = kept.part;
  json.update({{"version", kVersion}, {"key", key}, {"cpu_s", kept.cpu_s}, {"date", kept.date}});
  return json;
}

// Texts of the file are printed and stand in the report: one line each, without control characters. The numbers of a
// part are whole and small; a larger one must not reach an enumerator, which takes its lowest eight bits.
void clean(Json& json) {
  constexpr std::uint64_t kMostNumber = 3;
  if (json.is_number() && !(json.is_number_unsigned() && json.get<std::uint64_t>() <= kMostNumber))
    throw InputError("a number that there is not");
  if (json.is_structured()) {
    for (Json& entry : json) clean(entry);
  } else if (json.is_string()) {
    std::string text = clean_utf8(json.get<std::string>());
    std::replace(text.begin(), text.end(), '\n', ' ');
    json = std::move(text);
  }
}

KeptPart read_part(Json json) {
  KeptPart kept;
  kept.cpu_s = json.at("cpu_s").get<double>();
  for (const char* const checked : {"cpu_s", "version"}) json.erase(checked);
  constexpr double kMostCpu_s = 1.0e9;
  if (!(kept.cpu_s >= 0.0 && kept.cpu_s < kMostCpu_s)) throw InputError("a time that there is not");
  clean(json);
  json.at("date").get_to(kept.date);
  json.get_to(kept.part);
  bool is_known = kept.part.origin <= Origin::kSimulatedAndReal;
  for (const Picture& picture : kept.part.pictures) is_known &= picture.across >= 1 && picture.across <= 3;
  for (const Row& row : kept.part.rows) is_known &= row.verdict <= Verdict::kOpen;
  if (!is_known) throw InputError("a value that there is not");
  return kept;
}

// A name of a picture leads to no other folder and means nothing in HTML or Markdown.
bool pictures_are_there(const Part& part, const std::string& folder) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
  for (const Picture& picture : part.pictures) {
    std::error_code failed;
    if (picture.file.find_first_not_of(kLetters) != std::string::npos) return false;
    if (!fs::is_regular_file(folder + "/" + picture.file, failed) ||
        fs::file_size(folder + "/" + picture.file, failed) == 0)
      return false;
  }
  return true;
}

constexpr const char* kMark = "/.gdtslam-reproduce";

void rename(const std::string& from, const std::string& to) {
  std::error_code failed;
  fs::rename(from, to, failed);
  if (failed) throw FileError(to, "cannot be written: " + failed.message());
}

}  // namespace

Store::Store(const std::string& folder) : folder_(folder) { make_folder(folder + "/parts"); }

std::optional<KeptPart> Store::find(const std::string& id, const std::string& key) const {
  constexpr std::size_t kMostBytes = std::size_t{1} << 20U;  // what parts write has some 10 KB
  const std::string file = folder_of(id) + "/part.json";
  std::error_code failed;
  if (!fs::exists(file, failed)) return std::nullopt;
  try {
    const Json json = read_json(file, kMostBytes);
    if (json.at("version") != kVersion || json.at("key").get<std::string>() != key) return std::nullopt;
    KeptPart kept = read_part(json);
    if (pictures_are_there(kept.part, folder_of(id))) return kept;
  } catch (const Json::exception&) {  // cut or changed by hand: it is made again
  } catch (const InputError&) {
  }
  return std::nullopt;
}

std::string Store::begin(const std::string& id) {
  std::string folder = folder_of(id) + kMaking;
  make_marked_folder(folder);
  return folder;
}

void Store::keep(const std::string& id, const std::string& key, const KeptPart& part) {
  const std::string making = folder_of(id) + kMaking;
  write_json(making + "/part.json", as_json(key, part));
  replace_own_folder(making, folder_of(id));
}

void Store::drop(const std::string& id) noexcept {
  // An error is on its way already: begin() removes what is left the next time, or says what is wrong.
  without_throwing([&] { remove_own_folder(folder_of(id) + kMaking); });
}

void Store::require_own(const std::string& id) const {
  require_own_folder(folder_of(id));
  require_own_folder(folder_of(id) + kMaking);
}

std::string utc_text() { return fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr))); }

bool is_marked_folder(const std::string& path) {
  std::error_code ignored;  // what cannot be looked at has no mark
  return fs::is_directory(fs::symlink_status(path, ignored)) && fs::is_regular_file(path + kMark, ignored);
}

void require_own_folder(const std::string& path) {
  std::error_code failed;
  const fs::file_status status = fs::symlink_status(path, failed);
  if (!fs::exists(status) || is_marked_folder(path)) return;
  if (fs::is_directory(status) && list_folder(path, failed).empty() && !failed) return;
  throw FileError(path, "was not made by gdtslam reproduce and is left alone; move it away, or give another -o DIR");
}

void make_marked_folder(const std::string& path) {
  remove_own_folder(path);
  make_folder(path);
  // In one step: whoever is killed here leaves an empty folder or one with the mark.
  const std::string file = path + kMark;
  const int mark = retried([&] { return ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666); });
  const bool is_whole = mark >= 0 && write_whole(mark, "gdtslam reproduce made this folder and removes it again.\n");
  const int code = errno;
  if (mark >= 0) ::close(mark);
  if (!is_whole) throw FileError(path, "cannot be written to: " + errno_text(code));
}

void remove_own_folder(const std::string& path) {
  require_own_folder(path);
  std::error_code failed;
  std::error_code missing;
  // The mark goes last, so that what is left where this is cut short is still known for the program's.
  if (!fs::exists(path, missing) || remove_all_beside(path + kMark, failed)) remove_tree(path, failed);
  if (failed) throw FileError(path, "cannot be removed: " + failed.message());
}

void replace_own_folder(const std::string& from, const std::string& to) {
  require_own_folder(to);
  std::error_code failed;
  if (!fs::exists(to, failed)) return rename(from, to);
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_EXCHANGE) == 0) return remove_own_folder(from);
  if (errno != EINVAL && errno != ENOSYS) throw FileError(to, "cannot be written: " + errno_text(errno));
  const std::string old = to + ".old";  // a file system that exchanges no names: for a moment only this is there
  remove_own_folder(old);
  rename(to, old);
  try {
    rename(from, to);
  } catch (const FileError&) {
    fs::rename(old, to, failed);
    throw;
  }
  remove_own_folder(old);
}

}  // namespace gdtslam::reproduce
