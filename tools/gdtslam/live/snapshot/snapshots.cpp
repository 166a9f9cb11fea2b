#include "snapshots.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/core/signals_blocked.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/folder/snapshot_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using SnapshotClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSnapshotSlice{50};  // after which signals and clocks are looked at
constexpr std::chrono::seconds kBetweenShown{1};
constexpr int kLeastUrgent = 19;
constexpr mode_t kAllMayLook = 0777;  // as far as the user's mask lets them

std::atomic<bool> g_is_save_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void on_save_signal(int /*signal*/) { g_is_save_wanted = true; }

// Both folders change places, so that there is one of that name at any time; where a file system cannot do that the old
// one goes first, to that place. Nothing is removed under the name itself, which may be another folder's by then.
void give_name(const std::string& made, const std::string& name, const std::string& old) {
  if (::renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, name.c_str(), RENAME_EXCHANGE) == 0) return;
  ::rename(name.c_str(), old.c_str());
  if (::rename(made.c_str(), name.c_str()) != 0) throw FileError(name, "cannot be replaced: " + errno_text(errno));
}

}  // namespace

void let_signal_save() {
  struct sigaction action {};
  action.sa_handler = on_save_signal;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGUSR1, &action, nullptr);
}

void Snapshots::start(std::string scratch) {
  scratch_ = std::move(scratch);
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { work(); });
}

void Snapshots::stop() {
  is_ending_ = true;
  if (thread_.joinable()) thread_.join();
}

std::string Snapshots::name() const { return plan_.folder + "/" + kSnapshotFolder; }

// That of an earlier drive.
void Snapshots::remove_old() const {
  const std::string old = scratch_ + "/snapshot.old";
  if (!is_snapshot(name()) || ::rename(name().c_str(), old.c_str()) != 0) return;
  remove_snapshot(old);
}

// A pose is more urgent than a picture of the map.
void Snapshots::work() {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kLeastUrgent);
  SnapshotClock::time_point last_saved = SnapshotClock::now();
  SnapshotClock::time_point last_shown = last_saved - kBetweenShown;
  bool has_begun = false;
  while (!is_ending_) {
    std::this_thread::sleep_for(kSnapshotSlice);
    const SnapshotClock::time_point now = SnapshotClock::now();
    const bool is_due = plan_.every_s > 0.0 && now - last_saved >= std::chrono::duration<double>(plan_.every_s);
    const bool is_asked = g_is_save_wanted.exchange(false);
    const bool is_watched = plan_.is_watched && now - last_shown >= kBetweenShown && plan_.is_watched();
    if (is_due) last_saved = now;
    if (is_watched) last_shown = now;
    if (!has_begun && record_.scans() > 0) {
      has_begun = true;
      remove_old();
    }
    record_.take_news();
    if (is_due || is_asked || is_watched) make(is_due || is_asked, is_watched);
  }
}

// Nothing new is no news; what cannot be made is said once, and the drive goes on.
void Snapshots::make(bool is_to_be_saved, bool is_to_be_shown) {
  const std::uint64_t scans = record_.scans();
  is_to_be_saved = is_to_be_saved && scans > saved_;
  is_to_be_shown = is_to_be_shown && scans > shown_;
  if (!is_to_be_saved && !is_to_be_shown) return;
  try {
    const DriveState state = record_.state();
    if (is_to_be_shown) plan_.show(state);
    if (is_to_be_shown) shown_ = scans;
    if (is_to_be_saved) save(state);
  } catch (const Error& error) {
    if (!plan_.is_quiet && error.what() != last_problem_) print_remark(std::string("no snapshot: ") + error.what());
    last_problem_ = error.what();
  }
}

void Snapshots::save(const DriveState& state) {
  require_no_foreign_snapshot(plan_.folder);
  const std::string made = scratch_ + "/snapshot";
  const std::string old = scratch_ + "/snapshot.old";
  std::error_code ignored;
  remove_tree(made, ignored);  // one that could not be written
  for (const std::string& left : {old, scratch_ + "/snapshot.new"}) remove_snapshot(left);
  if (::mkdir(made.c_str(), kAllMayLook) != 0) {
    throw FileError(plan_.folder, errno == ENOENT ? "is no longer the folder that the run is written to"
                                                  : "cannot be written to: " + errno_text(errno));
  }
  write_occupancy_map(made + "/" + kSnapshotMap, state.map);
  write_tum(made + "/" + kSnapshotTrajectory, state.trajectory);
  give_name(made, name(), old);
  give_back_what_came(made, old);
  sync_folder(plan_.folder);
  saved_ = state.trajectory.size();
  for (const std::string& left : {made, old}) remove_snapshot(left);
}

// Somebody may have put a file into the old one while this one was written: then that stays, and this one is none.
void Snapshots::give_back_what_came(const std::string& made, const std::string& old) const {
  for (const std::string& left : {made, old}) {
    std::error_code ignored;
    if (!std::filesystem::exists(std::filesystem::symlink_status(left, ignored)) || is_snapshot(left)) continue;
    give_name(left, name(), scratch_ + "/snapshot.new");
    require_no_foreign_snapshot(plan_.folder);
  }
}

}  // namespace gdtslam
