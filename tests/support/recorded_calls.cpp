#include "recorded_calls.hpp"

#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <regex>

namespace gdtslam::test {
namespace {

namespace fs = std::filesystem;

std::mutex guard;
std::optional<std::string> below;  // what is recorded
std::vector<std::string> calls;

// What follows the folder, without the parts of a name that differ from run to run; nothing of another folder's file.
std::optional<std::string> name_of(const std::string& path) {
  if (!below || !path.starts_with(*below)) return std::nullopt;
  std::string name = path.substr(below->size());
  if (name.empty()) return ".";
  if (name.front() != '/') return std::nullopt;
  static const std::regex changing(R"((^|/)\.[^/]*[0-9][^/]*)");
  return std::regex_replace(name.substr(1), changing, "$1~");
}

std::string path_of(int descriptor) {
  std::string path(4096, '\0');
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t size = ::readlink(link.c_str(), path.data(), path.size());
  path.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return path;
}

void record(const std::string& what, const std::string& path, const std::string& to = "") {
  const std::lock_guard lock(guard);
  const std::optional<std::string> name = name_of(path);
  if (!name) return;
  calls.push_back(what + " " + *name + (to.empty() ? "" : " to " + name_of(to).value_or(to)));
}

}  // namespace

RecordedCalls::RecordedCalls(const fs::path& folder) {
  const std::lock_guard lock(guard);
  below = fs::canonical(folder).string();
  calls.clear();
}

RecordedCalls::~RecordedCalls() {
  const std::lock_guard lock(guard);
  below.reset();
}

std::vector<std::string> RecordedCalls::all() const {
  const std::lock_guard lock(guard);
  return calls;
}

std::size_t RecordedCalls::place_of(const std::string& call) const {
  const std::vector<std::string> made = all();
  return static_cast<std::size_t>(std::find(made.begin(), made.end(), call) - made.begin());
}

}  // namespace gdtslam::test

extern "C" {

int fsync(int descriptor) {
  gdtslam::test::record("sync", gdtslam::test::path_of(descriptor));
  return static_cast<int>(::syscall(SYS_fsync, descriptor));
}

// There is a type of that name, too.
int recorded_flock(int descriptor, int operation) noexcept __asm__("flock");
int recorded_flock(int descriptor, int operation) noexcept {
  gdtslam::test::record("lock", gdtslam::test::path_of(descriptor));
  return static_cast<int>(::syscall(SYS_flock, descriptor, operation));
}

int rename(const char* from, const char* to) noexcept {
  gdtslam::test::record("rename", from, to);
  return static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  gdtslam::test::record((flags & 2U) != 0 ? "exchange" : "rename", from, to);  // 2: RENAME_EXCHANGE
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

}  // extern "C"
