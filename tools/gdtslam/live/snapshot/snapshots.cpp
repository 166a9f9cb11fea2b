#include "snapshots.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "engine/runs/folder/run_folder.hpp"
#include "engine/runs/transaction/folder_transaction.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using SnapshotClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSnapshotSlice{50};  // time between checks of signals and clocks
constexpr std::chrono::seconds kBetweenShown{1};
constexpr int kLeastUrgent = 19;

std::atomic<bool> g_is_save_wanted = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

extern "C" void on_save_signal(int /*signal*/) { g_is_save_wanted = true; }

}  // namespace

// The first scan is always a keyframe, so that the path begins with one.
void DriveRecord::take(const MappedScan& mapped) {
  const bool is_keyframe = mapped.match.merged || taken_ == 0;
  News news{.scan = {.stamp_s = mapped.match.stamp_s,
                     .T_front_base = mapped.match.T_map_base,
                     .ends_keyframe = is_keyframe && mapped.ends_observation,
                     .is_shown = is_keyframe && mapped.match.accepted},
            .ranges = {}};
  if (news.scan.is_shown) news.ranges = mapped.scan;
  const std::lock_guard lock(mutex_);
  ++taken_;
  news_.push_back(std::move(news));
  if (mapped.closed_keyframes.valid()) asked_ = mapped.closed_keyframes;
}

std::uint64_t DriveRecord::scans() const {
  const std::lock_guard lock(mutex_);
  return taken_;
}

// Takes over the closed loops once they are known; a mapper that has ended reports no more.
void DriveRecord::take_news() {
  std::vector<News> news;
  {
    const std::lock_guard lock(mutex_);
    news.swap(news_);
    if (asked_.valid()) awaited_ = std::exchange(asked_, {});
  }
  for (const News& one : news) {
    scans_.put(one.scan);
    if (one.scan.is_shown) {
      ranges_.put(one.ranges);
      T_front_shown_.push_back(one.scan.T_front_base);
    }
    if (!one.scan.ends_keyframe) continue;
    T_front_keyframes_.push_back(one.scan.T_front_base);
    shown_.push_back(T_front_shown_.size());
  }
  if (!awaited_.valid() || awaited_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  try {
    closed_ = std::exchange(awaited_, {}).get();
    map_.reset();
  } catch (const std::future_error&) {
  }
}

std::vector<Pose2> DriveRecord::keyframe_poses() const {
  std::vector<Pose2> poses = closed_.T_map_base;
  poses.resize(std::min(poses.size(), T_front_keyframes_.size()));
  for (std::size_t k = poses.size(); k < T_front_keyframes_.size(); ++k) {
    poses.push_back(closed_.T_closed_front * T_front_keyframes_[k]);
  }
  return poses;
}

void DriveRecord::cast(const std::vector<Pose2>& poses) {
  if (!map_) {
    map_.emplace(config_, limits_);
    to_cast_.emplace(ranges_);
    in_hand_.reset();
    cast_ = 0;
  }
  for (std::size_t k = 0; k < poses.size(); ++k) {
    for (; cast_ < shown_[k]; ++cast_) {
      if (!in_hand_) in_hand_ = to_cast_->next();
      const bool is_keyframe = T_front_shown_[cast_] == T_front_keyframes_[k];
      map_->add(*in_hand_, is_keyframe ? poses[k] : poses[k] * between(T_front_keyframes_[k], T_front_shown_[cast_]));
      in_hand_.reset();
    }
  }
}

DriveState DriveRecord::state() {
  take_news();
  const std::vector<Pose2> poses = keyframe_poses();
  cast(poses);
  DriveState state{.map = map_->build(), .trajectory = {}};
  state.trajectory.reserve(scans_.size());
  Shelf<Scan>::Reader scans(scans_);
  std::size_t next = 0;  // index of a keyframe
  while (state.trajectory.size() < scans_.size()) {
    const Scan scan = scans.next();
    if (scan.ends_keyframe) ++next;
    state.trajectory.push_back(
        {scan.stamp_s, poses[next - 1] * between(T_front_keyframes_[next - 1], scan.T_front_base)});
  }
  return state;
}

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
      if (is_snapshot(name())) remove_snapshot(name());  // left by an earlier drive
    }
    record_.take_news();
    if (is_due || is_asked || is_watched) make(is_due || is_asked, is_watched);
  }
}

// Without new scans there is no new snapshot. A failure is reported once, and the drive goes on.
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
