#include "runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "engine/core/files/folder_calls.hpp"
#include "engine/io/message_text.hpp"
#include "engine/runs/fleet/input.hpp"
#include "engine/runs/fleet/kept_run.hpp"
#include "engine/runs/fleet/shards.hpp"
#include "engine/runs/fleet/state.hpp"
#include "engine/runs/fleet/unit.hpp"
#include "engine/runs/fleet/work_folder.hpp"
#include "gdtslam/core/error.hpp"
#include "node.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/workers.hpp"

namespace gdtslam {
namespace {

constexpr unsigned kMostProcesses = 1024;
constexpr unsigned kTries = 2;
constexpr std::size_t kMostLogsTriedAgain = 100;  // of those in a row that fail by themselves: their disk is gone
constexpr const char* kNoLog = "no log: ";        // in place of a record, before the reason

Settings settings_for(const FleetPlan& plan) {
  Settings settings = plan_settings(plan);
  const FleetReading& reading = plan.reading;
  state_recording({reading.topics, reading.odometry, reading.crank, reading.mounts}, settings.log);
  return settings;
}

std::string staging_parent(const std::string& atlas, const StoredPlan& stored) {
  require_same_atlas(atlas, stored);
  return atlas + "/staging";
}

/// Units in processes of their own.
class Runner {
 public:
  using Done = std::function<void(UnitRecord)>;

  Runner(const StoredPlan& stored, const RunnerOptions& options, bool is_kept)
      : stored_(stored),
        options_(options),
        device_(of_one_thread(options.device)),
        is_kept_(is_kept),
        settings_(settings_for(stored.plan)),
        processes_(std::min(options.processes == 0 ? usable_processors() : options.processes, kMostProcesses)),
        local_(local_work_parent()),
        staging_(is_kept ? staging_parent(options.atlas, stored) : local_.path()),
        place_(checked_node(stored, is_kept ? options.atlas : std::string(), device_, local_.path() + "/sample")),
        line_(options.quiet) {}

  /// The largest first. Failures are those that stayed; those of `blocked` units have a reason of their own and tell
  /// nothing of the rest.
  std::vector<UnitFailure> run(const std::vector<std::size_t>& units, const std::set<std::size_t>& blocked,
                               const Done& done) {
    blocked_ = blocked;
    std::vector<std::size_t> order = units;
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return work_s(a) > work_s(b); });
    for (const std::size_t unit : order) all_s_ += work_s(unit);
    queue_.assign(order.begin(), order.end());
    units_ = units.size();
    Workers workers(processes_);
    for (;;) {
      while (!is_given_up() && !workers.is_full() && !queue_.empty()) begin(workers);
      if (workers.is_idle()) break;
      take(workers.wait_for_any(), done);  // what is in hand is not lost to others that fail
    }
    if (is_given_up() && failures_.empty()) failures_.push_back(last_);
    line_.clear();
    return std::move(failures_);
  }

 private:
  [[nodiscard]] double work_s(std::size_t unit) const { return estimated_work_s(stored_.plan.units[unit]); }

  [[nodiscard]] std::string folder_of(std::size_t unit) const { return fmt::format("{}/{}", local_.path(), unit); }

  void begin(Workers& workers) {
    const std::size_t unit = queue_.front();
    queue_.pop_front();
    ++tries_[unit];
    shares_[unit] = 0.0;
    workers.start(unit, [this, unit](const Workers::Tell& tell) {
      try {
        return record_text(work_on(unit, tell));
      } catch (const LogUnavailable& error) {
        return std::string(kNoLog) + error.what();
      }
    });
  }

  // In the worker.
  UnitRecord work_on(std::size_t unit, const Workers::Tell& tell) {
    const UnitWork work{.stored = stored_,
                        .unit = unit,
                        .atlas = options_.atlas,
                        .settings = settings_,
                        .folder = folder_of(unit),
                        .staging = staging_.path(),
                        .place = place_,
                        .map =
                            [this](MapRequest request) {
                              request.on_failure = on_failure_of(device_);
                              BackendWhenNeeded backend(device_);
                              return map_logs(request,
                                              [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
                            },
                        .progress = tell,
                        .stop = [] { return interrupted(); }};
    return is_kept_ ? do_unit(work) : compute_unit(work);
  }

  void take(const Workers::Event& event, const Done& done) {
    shares_[event.id] = std::clamp(event.share, 0.0, 1.0);
    if (event.result || event.failure) end(event, done);
    line_.draw([this](double elapsed_s) { return progress(elapsed_s); });
  }

  void end(const Workers::Event& event, const Done& done) {
    shares_.erase(event.id);
    std::error_code ignored;  // the whole folder goes in the end
    remove_tree(folder_of(event.id), ignored);
    if (event.result && event.result->starts_with(kNoLog)) {
      return fail(event.id, {ExitCode::kInputOutput, event.result->substr(std::string_view(kNoLog).size())}, true);
    }
    if (event.result) {
      in_a_row_ = logs_in_a_row_ = 0;
      ++finished_;
      done_s_ += work_s(event.id);
      UnitRecord record = parse_record(*event.result, "a worker's record");
      refused_ += record.is_mapped() ? 0U : 1U;
      if (!record.is_mapped()) line_.clear();
      return done(std::move(record));
    }
    if (event.failure->code == ExitCode::kInterrupted && interrupted()) return;
    fail(event.id, *event.failure, event.failure->by_signal || event.failure->for_memory);
  }

  // Where the atlas is gone every unit fails, and one line says why. What is of the log tells nothing of others: it
  // cannot be had, needs more memory than there is, or breaks the program.
  void fail(std::size_t unit, const Workers::Failure& failure, bool is_of_log) {
    require_same_atlas(options_.atlas, stored_);
    const bool is_blocked = blocked_.contains(unit);
    if (is_of_log) {
      logs_in_a_row_ += tries_[unit] == 1 ? 1U : 0U;
    } else if (!is_blocked) {
      ++in_a_row_;
    }
    const bool is_tried_again =
        !is_blocked && tries_[unit] < kTries && !(is_of_log && logs_in_a_row_ >= kMostLogsTriedAgain);
    line_.clear();
    print_remark(
        fmt::format("unit {} is not done{}: {}", unit, is_tried_again ? " and is tried again" : "", failure.message));
    if (is_tried_again) {
      queue_.push_back(unit);
    } else {
      failures_.push_back({unit, failure.code, failure.message});
    }
    last_ = {unit, failure.code, failure.message};
  }

  // A disk that is full or gone fails every unit: trying them all would only take time.
  [[nodiscard]] bool is_given_up() const {
    constexpr std::size_t kLongestRow = 6;
    return in_a_row_ >= kLongestRow;
  }

  [[nodiscard]] std::string progress(double elapsed_s) const {
    double now_s = done_s_;
    for (const auto& [unit, share] : shares_) now_s += share * work_s(unit);
    const double share = all_s_ > 0.0 ? now_s / all_s_ : 1.0;
    std::string text = fmt::format("{:3.0f} %  {} of {} logs", 100.0 * share, finished_, units_);
    if (refused_ > 0) text += fmt::format(", {} refused", refused_);
    constexpr double kTelling = 0.02;
    if (share > kTelling) text += fmt::format("  {} left", time_left_text(elapsed_s * (1.0 - share) / share));
    return text;
  }

  const StoredPlan& stored_;
  const RunnerOptions& options_;
  DeviceOptions device_;
  bool is_kept_;
  Settings settings_;
  unsigned processes_;
  WorkFolder local_;
  WorkFolder staging_;
  UnitPlace place_;
  TerminalLine line_;
  std::deque<std::size_t> queue_;
  std::set<std::size_t> blocked_;
  std::map<std::size_t, unsigned> tries_;
  std::map<std::size_t, double> shares_;  ///< of what is in hand
  std::vector<UnitFailure> failures_;
  UnitFailure last_;
  std::size_t units_ = 0;
  std::size_t finished_ = 0;
  std::size_t refused_ = 0;
  std::size_t in_a_row_ = 0;       ///< failures
  std::size_t logs_in_a_row_ = 0;  ///< that fail by themselves at the first try
  double all_s_ = 0.0;
  double done_s_ = 0.0;
};

void print_refused(const UnitRecord& record, bool is_quiet) {
  if (!is_quiet && !record.is_mapped()) print_remark(fmt::format("{} is refused: {}", record.uri, record.reason));
}

// Units whose run folder lies there without its report, where somebody's files may be: it is in the way.
std::set<std::size_t> blocked_units(const std::string& atlas, const AtlasState& state) {
  std::set<std::size_t> blocked;
  for (const UnitRecord& record : state.lost) {
    try {
      (void)is_run_there(atlas + "/" + run_path(record.run));
    } catch (const FileError&) {
      blocked.insert(record.unit);
    }
  }
  return blocked;
}

constexpr std::uint64_t kNano = 1'000'000'000;

}  // namespace

std::size_t MostRefused::of(std::size_t units) const {
  constexpr std::uint64_t kAll = 100 * kNano;
  return is_share ? (share_nano_percent * units + kAll - 1) / kAll : count;
}

MostRefused parse_most_refused(const std::string& option, const std::string& text) {
  constexpr double kPercent = 100.0;
  MostRefused most;
  double number = 0.0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string unit(end, text.data() + text.size());
  std::erase(unit, ' ');
  most.is_share = unit == "%";
  const bool is_sound =
      most.is_share ? number <= kPercent : unit.empty() && number == std::floor(number) && number < 1e9;
  if (code != std::errc{} || !(number >= 0.0) || !is_sound)
    throw UsageError(option + ": " + in_quotes(text) + " is neither a number of logs nor a share such as 2%");
  if (most.is_share) {
    most.share_nano_percent = static_cast<std::uint64_t>(std::llround(number * static_cast<double>(kNano)));
  } else {
    most.count = static_cast<std::size_t>(number);
  }
  return most;
}

RunnerOutcome run_shards(const StoredPlan& stored, const std::vector<std::size_t>& shards,
                         const RunnerOptions& options) {
  AtlasState state = read_state_of_kept_runs(options.atlas, stored);
  for (const std::string& damage : state.damaged) print_remark(damage);
  if (!state.lost.empty() && !options.quiet)
    print_remark(
        fmt::format("the run folders of {} logs of the atlas are gone or have no report; those of what is run here are "
                    "mapped anew, once what is left of them is removed",
                    state.lost.size()));
  RunnerOutcome outcome;
  std::vector<std::size_t> units;
  for (const std::size_t shard : shards) {
    for (const std::uint32_t unit : stored.plan.shards.at(shard)) {
      ++outcome.units;
      if (!state.records[unit]) units.push_back(unit);
    }
  }
  outcome.were_done = outcome.units - units.size();
  if (units.empty()) {
    for (const std::string& parent : {local_work_parent(), options.atlas + "/staging"}) remove_left_work(parent);
  } else {
    Runner runner(stored, options, true);
    outcome.failures = runner.run(units, blocked_units(options.atlas, state), [&](UnitRecord record) {
      print_refused(record, options.quiet);
      const std::size_t unit = record.unit;
      state.records[unit] = std::move(record);
    });
  }
  for (const std::size_t shard : shards) {
    write_shard_table(options.atlas, stored, shard, state);
    for (const std::uint32_t unit : stored.plan.shards.at(shard)) {
      if (state.records[unit]) ++(state.records[unit]->is_mapped() ? outcome.mapped : outcome.refused);
    }
  }
  return outcome;
}

ComputedAgain compute_again(const StoredPlan& stored, const std::vector<std::size_t>& units,
                            const RunnerOptions& options) {
  std::map<std::size_t, UnitRecord> records;
  Runner runner(stored, options, false);
  ComputedAgain again;
  again.failures = runner.run(units, {}, [&records](UnitRecord record) {
    const std::size_t unit = record.unit;
    records[unit] = std::move(record);
  });
  for (auto& [unit, record] : records) again.records.push_back(std::move(record));
  return again;
}

}  // namespace gdtslam
