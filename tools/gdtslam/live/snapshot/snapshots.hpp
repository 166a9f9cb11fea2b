// Map and path of a drive as files, every few seconds and when a signal asks for them, by a thread of its own; and for
// those who watch the drive. The folder takes its name as a whole: whoever looks finds the files of one moment.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "drive_record.hpp"

namespace gdtslam {

/// Lets SIGUSR1 ask for a snapshot, instead of ending the process. Call it before any thread starts.
void let_signal_save();

class Snapshots {
 public:
  struct Plan {
    std::string folder;    ///< of the run; the files go into its folder `snapshot`
    double every_s = 0.0;  ///< 0: only when the signal comes
    bool is_quiet = false;
    /// Whether somebody watches, and what is shown to them then, once a second.
    std::function<bool()> is_watched{};
    std::function<void(const DriveState&)> show{};
  };
  /// `record` must outlive this.
  Snapshots(DriveRecord& record, Plan plan) : record_(record), plan_(std::move(plan)) {}
  Snapshots(const Snapshots&) = delete;
  Snapshots& operator=(const Snapshots&) = delete;
  ~Snapshots() { stop(); }

  /// Begins. Nothing is written before the first scan.
  void start();
  /// Ends the thread, after the snapshot at work. The run that takes the snapshot's place removes it.
  void stop();

 private:
  void work();
  void make(bool is_to_be_saved, bool is_to_be_shown);
  void save(const DriveState& state);
  [[nodiscard]] std::string name() const;

  DriveRecord& record_;
  Plan plan_;
  std::uint64_t saved_ = 0;  // scans of the last snapshot
  std::uint64_t shown_ = 0;
  std::string last_problem_;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace gdtslam
