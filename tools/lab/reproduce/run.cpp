#include "run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <utility>

#include "drives.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/sha256.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "engine/runs/mapping/stopwatch.hpp"
#include "engine/runs/transaction/folder_lock.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#ifdef GDTSLAM_HAS_MODULES
#include "tools/gdtslam/shell/modules.hpp"
#endif
#include "tools/gdtslam/shell/workers.hpp"

namespace gdtslam::reproduce {
namespace {

// A program that was built anew may give something else, whatever its version says.
std::string program_key() {
  Sha256 key;
  key.update(read_text<InputError>("/proc/self/exe"));
#ifdef GDTSLAM_HAS_MODULES
  key.update(read_text<InputError>(module_file("reproduce")));
#endif
  return key.hex();
}

std::string part_key(const PartInfo& info, const std::string& program, const Options& options,
                     const std::vector<RealLog>& logs) {
  Sha256 key;
  key.update(program).update(info.id).update(options.device.device);
  for (const std::string_view drive : info.drives) key.update(Drives::key_of(drive));
  if (info.data_weight_s > 0.0) {
    for (const RealLog& log : logs)
      key.update(read_text<InputError>(log.log)).update(read_text<InputError>(log.relations));
  }
  return key.hex();
}

unsigned processors() { return std::max(1U, std::thread::hardware_concurrency()); }

// In a process of its own, as all that may start threads or open a device.
Host host_of(const DeviceOptions& device) {
  Workers worker(1);
  worker.start(0, [&device](const Workers::Tell&) {
    const DeviceInfo chosen = make_backend(device)->device();
    const std::string name =
        chosen.kind == "cpu" ? fmt::format("CPU, {}", chosen.driver) : chosen.name + ", " + chosen.driver;
    return nlohmann::json{{"device", name}, {"processor", make_cpu({})->device().name}}.dump();
  });
  Workers::Event event;
  while (!event.result) event = worker.wait();
  const auto said = nlohmann::json::parse(*event.result);
  return {GDTSLAM_VERSION, said.at("device").get<std::string>(), said.at("processor").get<std::string>(), processors()};
}

const std::string& folder_made(const std::string& folder) {
  std::error_code ignored;
  for (const char* const name : {"/report.html", "/report.md"}) {
    if (!std::filesystem::exists(folder + name, ignored) || std::filesystem::exists(folder + "/parts", ignored))
      continue;
    throw FileError(folder + name, "was not made by gdtslam reproduce, which would replace it; give another folder");
  }
  make_folder(folder);
  return folder;
}

/// A drive or a part that is to be made.
struct Job {
  std::string name;
  double weight_s = 0.0;
  PartState* part = nullptr;        ///< nothing: a drive
  std::vector<std::size_t> needs;   ///< jobs of drives
  std::vector<std::size_t> pays{};  ///< of them those whose time counts as this part's
  double cpu_s = 0.0;
  double share = 0.0;  ///< done
  enum class State : std::uint8_t { kWaiting, kRunning, kDone } state = State::kWaiting;
};

class Reproduction {
 public:
  explicit Reproduction(const Options& options)
      : options_(options),
        logs_(real_logs(options.data)),
        program_(program_key()),
        lock_(folder_made(options.folder)),
        store_(options.folder),
        device_(one_thread(options.device)),
        workers_(options.device.threads == 0 ? processors() : options.device.threads),
        drives_(options.folder + "/work", program_, device_, [] { return interrupted(); }) {
    result_.host = host_of(device_);
    result_.html = options.folder + "/report.html";
    result_.markdown = options.folder + "/report.md";
    for (const PartInfo& info : part_list()) {
      keys_[std::string(info.id)] = part_key(info, program_, options, logs_);
      result_.parts.push_back({&info, store_.find(std::string(info.id), keys_.at(std::string(info.id)))});
    }
  }

  Result run() {
    Stopwatch watch;
    plan();
    try {
      make_all();
    } catch (const Error& error) {
      find_finished();
      watch.add_to(result_.wall_s);
      write_report();
      if (error.code() != ExitCode::kInterrupted) throw;
      throw Error(ExitCode::kInterrupted,
                  fmt::format("interrupted; {} of {} parts are made and kept, the same command goes on",
                              parts_made(result_), result_.parts.size()));
    }
    watch.add_to(result_.wall_s);
    write_report();
    if (!options_.keep_runs) drives_.clear();
    return std::move(result_);
  }

 private:
  static DeviceOptions one_thread(DeviceOptions device) {
    device.threads = 1;
    return device;
  }
  [[nodiscard]] bool is_wanted(const PartState& state) const {
    const auto& only = options_.only;
    const bool is_named = only.empty() || std::find(only.begin(), only.end(), state.info->id) != only.end();
    return is_named && (options_.force || !state.kept);
  }
  [[nodiscard]] double weight_of(const PartInfo& info) const {
    return info.weight_s + (logs_.empty() ? 0.0 : info.data_weight_s);
  }

  // In the order of the report, drives before the first part that needs them.
  void plan() {
    for (PartState& state : result_.parts) {
      if (!is_wanted(state)) continue;
      store_.require_own(std::string(state.info->id));
      Job job{.name = std::string(state.info->id), .weight_s = weight_of(*state.info), .part = &state, .needs = {}};
      for (const std::string_view drive : state.info->drives) {
        if (drives_.is_made(drive)) continue;
        const auto is_drive = [drive](const Job& other) { return other.part == nullptr && other.name == drive; };
        const auto planned = std::find_if(jobs_.begin(), jobs_.end(), is_drive);
        job.needs.push_back(static_cast<std::size_t>(planned - jobs_.begin()));
        if (planned != jobs_.end()) continue;
        drives_.require_own(drive);
        job.pays.push_back(jobs_.size());
        jobs_.push_back({.name = std::string(drive), .weight_s = recipe_of(drive).weight_s, .needs = {}});
      }
      jobs_.push_back(std::move(job));
    }
    if (std::any_of(jobs_.begin(), jobs_.end(), [](const Job& job) { return job.part == nullptr; })) drives_.prepare();
  }

  [[nodiscard]] Job* next_job() {
    const auto is_done = [this](std::size_t need) { return jobs_[need].state == Job::State::kDone; };
    for (Job& job : jobs_) {
      const bool is_ready = std::all_of(job.needs.begin(), job.needs.end(), is_done);
      if (job.state == Job::State::kWaiting && is_ready) return &job;
    }
    return nullptr;
  }

  void make_all() {
    TerminalLine line(options_.quiet);
    Workers workers(workers_);
    for (;;) {
      for (Job* job = nullptr; !workers.is_full() && (job = next_job()) != nullptr;) begin(*job, workers);
      if (workers.is_idle()) return;
      const Workers::Event event = workers.wait();
      Job& job = jobs_[event.id];
      job.share = std::clamp(event.share, 0.0, 1.0);
      if (event.result) finish(job, event.cpu_s, line);
      line.draw([&](double /*elapsed_s*/) {
        return progress_text(shares(), parts_of_run(true), parts_of_run(), left_s(line));
      });
    }
  }

  void begin(Job& job, Workers& workers) {
    double paid_s = 0.0;
    for (const std::size_t drive : job.pays) paid_s += jobs_[drive].cpu_s;
    workers.start(static_cast<std::size_t>(&job - jobs_.data()), [&, paid_s](const Workers::Tell& tell) {
      if (job.part == nullptr) {
        drives_.make(job.name, tell);
      } else {
        make_part(*job.part->info, paid_s, tell);
      }
      return std::string();
    });
    job.state = Job::State::kRunning;
  }

  // In the worker.
  void make_part(const PartInfo& info, double paid_s, const Workers::Tell& tell) {
    const std::string id(info.id);
    try {
      Stopwatch watch;
      const PartContext place{.folder = store_.begin(id),
                              .drives = drives_,
                              .device = device_,
                              .data = options_.data,
                              .progress = tell,
                              .stop = [] { return interrupted(); }};
      KeptPart kept{info.make(place), paid_s, utc_text()};
      if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
      double wall_s = 0.0;
      watch.add_to(wall_s, kept.cpu_s);
      store_.keep(id, keys_.at(id), kept);
    } catch (...) {
      store_.drop(id);
      throw;
    }
  }

  void finish(Job& job, double cpu_s, TerminalLine& line) {
    job.cpu_s = cpu_s;
    job.state = Job::State::kDone;
    if (job.part != nullptr) {
      find(*job.part);
      job.part->is_new = true;
      if (!job.part->kept) throw FileError(store_.folder_of(job.name), "was made and cannot be read");
    }
    line.clear();
    if (options_.quiet) return;
    const std::size_t made = parts_of_run(true);
    const std::string left = made < parts_of_run() ? fmt::format(", about {} left", time_left_text(left_s(line))) : "";
    print_remark(job.part == nullptr ? fmt::format("{} simulated, {:.1f} s of CPU time", job.name, cpu_s)
                                     : fmt::format("{} made, {:.1f} s of CPU time ({} of {}{})", job.name, cpu_s, made,
                                                   parts_of_run(), left));
  }

  /// Of what is in hand, by name.
  [[nodiscard]] std::map<std::string, double> shares() const {
    std::map<std::string, double> shares;
    for (const Job& job : jobs_) {
      if (job.state == Job::State::kRunning) shares[job.name] = job.share;
    }
    return shares;
  }
  [[nodiscard]] std::size_t parts_of_run(bool is_made = false) const {
    return static_cast<std::size_t>(std::count_if(jobs_.begin(), jobs_.end(), [is_made](const Job& job) {
      return job.part != nullptr && (!is_made || job.state == Job::State::kDone);
    }));
  }
  // The weights, at the speed of what is done so far.
  [[nodiscard]] double left_s(const TerminalLine& line) const {
    constexpr double kTelling_s = 2.0;  // of what is done before its speed tells more than the weights do
    double total_s = 0.0;
    double done_s = 0.0;
    for (const Job& job : jobs_) {
      total_s += job.weight_s;
      done_s += job.state == Job::State::kDone ? job.weight_s : job.share * job.weight_s;
    }
    const double pace = done_s > kTelling_s ? line.elapsed_s() / done_s : 1.0 / std::max(1U, workers_);
    return pace * std::max(0.0, total_s - done_s);
  }

  void find(PartState& state) {
    const std::string id(state.info->id);
    const bool was_kept = state.kept.has_value();
    state.kept = store_.find(id, keys_.at(id));
    state.is_new = state.kept && !was_kept;
  }

  // After an error: what workers finished while they were stopped, and nothing of the others.
  void find_finished() {
    for (const Job& job : jobs_) {
      if (job.part == nullptr || job.state != Job::State::kRunning) continue;
      store_.drop(job.name);
      find(*job.part);
    }
  }

  void write_report() {
    AtomicFileSet files;
    files.add(result_.markdown).write(markdown_of(result_));
    files.add(result_.html).write(html_of(result_, store_));
    files.commit();
  }

  const Options& options_;
  std::vector<RealLog> logs_;
  std::string program_;
  FolderLock lock_;  ///< of all that is made and removed in there
  Store store_;
  DeviceOptions device_;  ///< of each worker
  unsigned workers_;
  Drives drives_;
  std::map<std::string, std::string> keys_;  ///< of the parts
  std::vector<Job> jobs_;
  Result result_;
};

}  // namespace

std::vector<std::string> checked_ids(const std::vector<std::string>& names) {
  std::vector<std::string> all;
  std::vector<std::string> ids;
  for (const PartInfo& info : part_list()) {
    all.emplace_back(info.id);
    if (!info.also.empty()) all.emplace_back(info.also);
  }
  for (const std::string& name : names) {
    const auto is_named = [&name](const PartInfo& info) {
      return info.id == name || (!name.empty() && info.also == name);
    };
    const auto info = std::find_if(part_list().begin(), part_list().end(), is_named);
    if (info == part_list().end()) {
      throw UsageError("--only: there is no part '" + name + "'" + did_you_mean(name, all) + " (--list names all)");
    }
    ids.emplace_back(info->id);
  }
  return ids;
}

std::string progress_text(const std::map<std::string, double>& shares, std::size_t made, std::size_t parts,
                          double left_s) {
  std::string text;
  for (const auto& [name, share] : shares)
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", name, 100.0 * share);
  return fmt::format("{}  ({} of {} parts made, {} left)", text, made, parts, time_left_text(left_s));
}

Result reproduce(const Options& options) { return Reproduction(options).run(); }

}  // namespace gdtslam::reproduce
