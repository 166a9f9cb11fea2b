#include "run_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <ctime>
#include <system_error>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kStagingPrefix = ".gdtslam-staging-";

std::string text_of(int code) { return std::generic_category().message(code); }

// Staging folders of processes that were killed.
void remove_leftovers(const fs::path& folder) {
  std::error_code ignored;  // what cannot be listed or removed is not in the way
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kStagingPrefix)) continue;
    pid_t process = 0;
    const char* const digits = name.data() + kStagingPrefix.size();
    const auto parsed = std::from_chars(digits, name.data() + name.size(), process);
    const bool is_dead = parsed.ec == std::errc{} && process > 0 && ::kill(process, 0) != 0 && errno == ESRCH;
    if (is_dead) fs::remove_all(entry.path(), ignored);
  }
}

void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) throw FileError(folder.string(), "cannot be opened: " + text_of(errno));
  const int failed = ::fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;  // EINVAL: no such thing there
  ::close(descriptor);
  if (failed != 0) throw FileError(folder.string(), "cannot be synced: " + text_of(failed));
}

// "intel" from "../data/intel.clf.gz".
std::string stem_of(const std::string& log) {
  if (log == "-") return "stdin";
  fs::path name = fs::path(log).filename();
  if (name.extension() == ".gz") name = name.stem();
  return name.stem().string();
}

std::string utc_time() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  return fmt::format("{:04}{:02}{:02}T{:02}{:02}{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday, utc.tm_hour,
                     utc.tm_min, utc.tm_sec);
}

}  // namespace

RunFolder::RunFolder(const std::string& path) : folder_(path) {
  std::error_code ignored;
  is_new_ = !fs::exists(folder_, ignored);
  make_folder(path);
  remove_leftovers(folder_);
  staging_ = folder_ / fmt::format("{}{}", kStagingPrefix, ::getpid());
  std::error_code failed;
  fs::remove_all(staging_, failed);
  if (!fs::create_directory(staging_, failed)) {
    throw FileError(path, "cannot be written to: " + failed.message());
  }
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  fs::remove_all(staging_, ignored);
  if (is_new_) fs::remove(folder_, ignored);  // succeeds only when it is empty
}

std::string RunFolder::staged(std::string_view name) {
  names_.emplace_back(name);
  return (staging_ / name).string();
}

// The old files get second names until every new one has its own, so that a failure half-way can be undone; copies
// where the file system offers no hard links.
std::vector<bool> RunFolder::keep_old(const fs::path& kept, const std::vector<std::string>& names) const {
  std::error_code failed;
  fs::create_directory(kept, failed);
  if (failed) throw FileError(folder_.string(), "cannot be written to: " + failed.message());
  std::vector<bool> existed;
  for (const std::string& name : names) {
    const fs::file_status status = fs::symlink_status(folder_ / name, failed);
    existed.push_back(fs::exists(status));
    if (!existed.back()) continue;
    if (fs::is_directory(status)) throw FileError(file(name), "cannot be replaced: " + text_of(EISDIR));
    fs::create_hard_link(folder_ / name, kept / name, failed);
    if (failed) fs::copy(folder_ / name, kept / name, fs::copy_options::copy_symlinks, failed);
    if (failed) throw FileError(file(name), "cannot be kept while it is replaced: " + failed.message());
  }
  return existed;
}

// Undoes a commit that failed; says what cannot be undone.
std::string RunFolder::put_back(const fs::path& kept, const std::vector<std::string>& names,
                                const std::vector<bool>& existed) const {
  std::string problems;
  for (std::size_t k = 0; k < names.size(); ++k) {
    std::error_code failed;
    if (existed[k]) {
      fs::rename(kept / names[k], folder_ / names[k], failed);
    } else {
      fs::remove(folder_ / names[k], failed);
    }
    if (failed) problems += "; nor can " + names[k] + " be put back: " + failed.message();
  }
  return problems;
}

void RunFolder::commit() {
  const fs::path kept = staging_ / "old";
  std::vector<std::string> names = names_;
  names.insert(names.end(), gone_.begin(), gone_.end());
  const std::vector<bool> existed = keep_old(kept, names);
  sync_folder(staging_);
  std::error_code failed;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (k < names_.size()) {
      fs::rename(staging_ / names[k], folder_ / names[k], failed);
    } else {
      fs::remove(folder_ / names[k], failed);
    }
    if (!failed) continue;
    const std::string reason = failed.message();
    const std::vector<std::string> done(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(k));
    throw FileError(file(names[k]), "cannot be replaced: " + reason + put_back(kept, done, existed));
  }
  names_.clear();
  gone_.clear();
  sync_folder(folder_);
}

std::string default_run_folder(const std::string& log) {
  const std::string base = fmt::format("runs/{}-{}", stem_of(log), utc_time());
  std::string path = base;
  std::error_code ignored;
  for (int k = 2; fs::exists(path, ignored); ++k) path = fmt::format("{}-{}", base, k);
  return path;
}

void link_latest(const std::string& run_folder) {
  const fs::path folder(run_folder);
  const fs::path link = folder.parent_path() / "latest";
  std::error_code failed;
  if (fs::exists(fs::symlink_status(link, failed)) && !fs::is_symlink(fs::symlink_status(link, failed))) return;
  const fs::path temporary = folder.parent_path() / fmt::format(".latest-{}", ::getpid());
  fs::remove(temporary, failed);
  fs::create_directory_symlink(folder.filename(), temporary, failed);
  if (!failed) fs::rename(temporary, link, failed);
  if (failed) throw FileError(link.string(), "cannot be linked to the run: " + failed.message());
}

}  // namespace gdtslam
