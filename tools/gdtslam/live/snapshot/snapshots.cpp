#include "snapshots.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/transaction/folder_transaction.hpp"
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

std::atomic<bool> g_is_save_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void on_save_signal(int /*signal*/) { g_is_save_wanted = true; }

}  // namespace

void let_signal_save() {
  struct sigaction action {};
  action.sa_handler = on_save_signal;
  action.sa_flags = SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  ::sigaction(SIGUSR1, &action, nullptr);
}

void Snapshots::start() {
  const SignalsBlocked blocked;
  thread_ = std::thread([this] { work(); });
}

void Snapshots::stop() {
  is_ending_ = true;
  if (thread_.joinable()) thread_.join();
}

std::string Snapshots::name() const { return plan_.folder + "/" + kSnapshotFolder; }

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
      if (is_snapshot(name())) remove_snapshot(name());  // of an earlier drive
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
  FolderTransaction snapshot(name());
  write_occupancy_map((snapshot.staging() / kSnapshotMap).string(), state.map);
  write_tum((snapshot.staging() / kSnapshotTrajectory).string(), state.trajectory);
  require_no_foreign_snapshot(plan_.folder);
  snapshot.commit();
  saved_ = state.trajectory.size();
}

}  // namespace gdtslam
