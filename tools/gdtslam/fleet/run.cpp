// gdtslam fleet run: maps logs in one process each, one per processor at a time.
#include <fmt/format.h>
#include <unistd.h>
#include <CLI/App.hpp>

#include <array>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/fleet/atlas.hpp"
#include "engine/runs/fleet/fleet_work.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"
#include "tools/gdtslam/shell/workers.hpp"

namespace gdtslam {
namespace {

struct RunOptions {
  std::vector<std::string> logs;
  std::string list;
  std::string atlas;
  std::string shard = "1/1";
  unsigned processes = 0;
  SettingsOptions settings;
  RecordingOptions recording;
  std::string linkage;
  bool lenient = false;
  DeviceOptions device;
  bool quiet = false;
};

std::vector<FleetLog> named_logs(const RunOptions& options) {
  std::vector<std::string> named = options.logs;
  if (!options.list.empty()) {
    const std::string text = read_text<InputError>(options.list);
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      if (end > begin) named.push_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  if (named.empty()) throw UsageError("name logs or folders of logs, or give --list FILE");
  return find_logs(named);
}

// All settings besides the log's bytes that affect the results.
std::string options_text(const RunOptions& options, Settings settings) {
  std::string text = fmt::format("gdtslam {}\n", GDTSLAM_VERSION);
  for (const std::string& topic : options.recording.topics) text += fmt::format("--topic {}\n", topic);
  if (!options.recording.odometry.empty()) text += fmt::format("--odom {}\n", options.recording.odometry);
  if (!options.recording.crank.empty()) text += fmt::format("--crank {}\n", options.recording.crank);
  for (const std::string& mount : options.recording.mounts) text += fmt::format("--mount {}\n", mount);
  if (options.lenient) text += "--lenient\n";
  text += config_text(option_table(settings));
  return options.linkage.empty() ? text : text + linkage_text(resolve_linkage(options.linkage));
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

FleetWork make_work(const RunOptions& options) {
  Settings settings = load_settings(options.settings);
  state_recording(options.recording, settings.log);
  FleetWork work{.atlas = options.atlas, .options = options_text(options, settings), .host = host_name()};
  work.request.settings = std::move(settings);
  work.request.lenient = options.lenient;
  work.request.linkage = options.linkage;
  work.request.with_continue_file = false;
  DeviceOptions device = options.device;
  device.are_threads_given = true;  // the processes alone use all processors
  work.request.on_failure = on_failure_of(device);
  work.request.stop = [] { return interrupted(); };
  work.map = [device](const MapRequest& request) {
    BackendWhenNeeded backend(device);
    return map_logs(request, [&backend](bool has_work) -> Backend& { return backend.of(has_work); });
  };
  return work;
}

/// Maps the logs of a shard in processes of their own, the largest first.
class FleetRun {
 public:
  FleetRun(const RunOptions& options, std::vector<FleetLog> logs)
      : options_(options), work_(make_work(options)), logs_(std::move(logs)), line_(options.quiet) {}

  [[nodiscard]] const std::string& options_text() const { return work_.options; }

  int run(const Shard& shard) {
    logs_ = logs_of_shard(logs_, shard);
    for (const FleetLog& log : logs_) left_bytes_ += weight(log);
    all_bytes_ = left_bytes_;
    Workers workers(threads_meant(options_.processes));
    std::size_t next = 0;
    for (;;) {
      for (; !workers.is_full() && next < logs_.size(); ++next) start(workers, next);
      if (workers.is_idle()) break;
      take(workers.wait_for_any());
    }
    line_.clear();
    if (!options_.quiet)
      print_result(fmt::format("{}: {} mapped, {} skipped as they are done, {} refused, {} failed\n",
                               plural(logs_.size(), "log"), mapped_, skipped_, refused_, failed_));
    if (code_ == 0) return code_;
    throw Error(static_cast<ExitCode>(code_), fmt::format("{} of {} not mapped; the same command tries again",
                                                          refused_ + failed_, plural(logs_.size(), "log")));
  }

 private:
  static double weight(const FleetLog& log) { return static_cast<double>(log.bytes) + 1.0; }

  void start(Workers& workers, std::size_t log) {
    workers.start(log, [this, log](const Workers::Tell& tell) {
      FleetWork work = work_;
      work.request.progress = [&tell](std::uint64_t, double share) { tell(share); };
      const MappedFleetLog done = map_fleet_log(work, logs_[log].path);
      const nlohmann::json said{{"outcome", done.was_done ? "skipped" : done.record.outcome},
                                {"code", done.record.exit_code},
                                {"reason", done.record.reason}};
      return said.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    });
  }

  void take(const Workers::Event& event) {
    shares_[event.id] = std::max(event.share, 0.0);
    if (event.result) {
      const auto done = nlohmann::json::parse(*event.result);
      end(event.id, done.at("outcome"), done.at("code"), done.at("reason"));
    } else if (event.failure) {
      fail(event.id, *event.failure);
    }
    line_.draw([this](double elapsed_s) { return progress(elapsed_s); });
  }

  // A killed process cannot write its record itself. If nothing can be written, no other log can be mapped.
  void fail(std::size_t log, const Workers::Failure& failure) {
    if (failure.code == ExitCode::kInputOutput || failure.code == ExitCode::kInterrupted)
      throw Error(failure.code, failure.message);
    const int code = static_cast<int>(failure.code);
    if (failure.by_signal || failure.for_memory) {
      write_record(options_.atlas, {.log = logs_[log].path,
                                    .outcome = "failed",
                                    .exit_code = code,
                                    .reason = failure.message,
                                    .host = work_.host});
    }
    end(log, "failed", code, failure.message);
  }

  // The exit code is that of the first failed log, else that of a refused log.
  void end(std::size_t log, const std::string& outcome, int code, const std::string& reason) {
    shares_.erase(log);
    left_bytes_ -= weight(logs_[log]);
    ++(outcome == "mapped" ? mapped_ : outcome == "skipped" ? skipped_ : outcome == "refused" ? refused_ : failed_);
    if (code == 0) return;
    line_.clear();
    print_remark(fmt::format("{} {}: {}", logs_[log].path, outcome, reason));
    if (outcome == "failed" && failed_ == 1) code_ = code;
    if (code_ == 0) code_ = static_cast<int>(ExitCode::kBadInput);
  }

  [[nodiscard]] std::string progress(double elapsed_s) const {
    double done = all_bytes_ - left_bytes_;
    for (const auto& [log, share] : shares_) done += share * weight(logs_[log]);
    const double share = done / all_bytes_;
    std::string text = fmt::format("{:3.0f} %  {} of {}", 100.0 * share, mapped_ + skipped_ + refused_ + failed_,
                                   plural(logs_.size(), "log"));
    constexpr double kTelling = 0.02;
    if (share > kTelling) text += fmt::format("  {} left", time_left_text(elapsed_s * (1.0 - share) / share));
    return text;
  }

  const RunOptions& options_;
  FleetWork work_;
  std::vector<FleetLog> logs_;
  TerminalLine line_;
  std::map<std::size_t, double> shares_;  ///< share done of each running log
  double all_bytes_ = 0.0;
  double left_bytes_ = 0.0;
  std::size_t mapped_ = 0;
  std::size_t skipped_ = 0;
  std::size_t refused_ = 0;
  std::size_t failed_ = 0;
  int code_ = 0;
};

int run_fleet(const RunOptions& options) {
  if (options.atlas.empty()) throw UsageError("--output: names no folder");
  const Shard shard = parse_shard(options.shard);
  (void)parse_device_name(options.device.device);
  (void)cpu_options(options.device);
  const std::vector<FleetLog> logs = named_logs(options);
  FleetRun run(options, logs);
  begin_atlas(options.atlas, run.options_text(), logs);
  return run.run(shard);
}

}  // namespace

void add_fleet_run(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = add_command(fleet, "run", "Map logs; what is mapped already is skipped");
  command
      ->add_option("log", options->logs,
                   "Logs, ROS 2 bags, or folders to be searched for them by the endings of their names")
      ->type_name("LOG");
  command->add_option("--list", options->list, "A list of logs or folders, one a line; - is standard input")
      ->type_name("FILE");
  command->add_option("-o,--output", options->atlas, "The atlas: a folder that all machines see, made if need be")
      ->required()
      ->type_name("ATLAS");
  command->add_option("--shard", options->shard, "Map the I-th of N parts of the logs, from 1")
      ->type_name("I/N")
      ->capture_default_str();
  add_count_option(*command, "-j,--jobs", options->processes, 1, "Logs at a time, a process each [one per processor]");
  add_settings_options(*command, options->settings);
  add_device_options(*command, options->device, false);
  command
      ->add_option("--linkage", options->linkage,
                   "Linkage of nodding lasers, a preset or a file [LOG.linkage.yaml beside each log]")
      ->type_name("NAME|FILE");
  command->add_flag("--lenient", options->lenient, "Count and skip malformed lines instead of refusing the log");
  add_recording_options(*command, options->recording);
  command->add_flag("-q,--quiet", options->quiet, "Print errors only");
  command->footer(
      "A log is skipped if its run folder is there and was made of the same bytes with the same options. One that "
      "cannot\n"
      "be mapped is recorded with its reason and stops nothing: exit 65 if only logs are to blame, else the code of "
      "the\n"
      "first that failed for the machine's sake (a disk, memory, a signal). The same command maps what is not mapped "
      "yet.\n"
      "All commands on an atlas have the same options. An interrupt drops the logs in hand, exit 130.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet run logs/ -o atlas\n"
      "  gdtslam fleet run logs/*.bag -o atlas -c fleet.yaml --set map.resolution=\"10 cm\"\n"
      "  gdtslam fleet run --list logs.txt -o /shared/atlas --shard 3/20 -j 8");
  command->callback([options, &context] {
    context.run = [options] { return run_fleet(*options); };
    context.when_out_of_memory = "fewer at a time (-j) need less";
  });
}

}  // namespace gdtslam
