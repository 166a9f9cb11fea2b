#include "reproduce_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>

#include "did_you_mean.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/atomic_file.hpp"
#include "gdtslam/io/sha256.hpp"
#include "interrupt.hpp"
#include "reproduce_data.hpp"
#include "reproduce_drives.hpp"
#include "reproduce_progress.hpp"
#include "reproduce_report.hpp"

namespace gdtslam::reproduce {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// A program that was built anew may give something else, whatever its version says.
std::string key_of_program() { return Sha256().update(text_of_file("/proc/self/exe")).hex(); }

std::string key_of(const PartInfo& info, const std::string& program, const Options& options,
                   const std::vector<RealLog>& logs) {
  Sha256 key;
  key.update(program).update(info.id).update(options.device.device);
  for (const std::string_view drive : info.drives) key.update(Drives::key_of(drive));
  if (info.data_weight_s > 0.0) {
    for (const RealLog& log : logs) key.update(text_of_file(log.log)).update(text_of_file(log.relations));
  }
  return key.hex();
}

Host host_of(const DeviceOptions& device) {
  const DeviceInfo chosen = make_backend(device)->device();
  return {GDTSLAM_VERSION,
          chosen.kind == "cpu" ? fmt::format("CPU, {}", chosen.driver) : chosen.name + ", " + chosen.driver,
          make_cpu({})->device().name, std::max(1U, std::thread::hardware_concurrency())};
}

class Reproduction {
 public:
  explicit Reproduction(const Options& options)
      : options_(options),
        logs_(real_logs(options.data)),
        program_(key_of_program()),
        store_(options.folder),
        drives_(options.folder + "/work", program_, options.device, [] { return interrupted(); }) {
    result_.host = host_of(options.device);
    result_.html = options.folder + "/report.html";
    result_.markdown = options.folder + "/report.md";
    for (const PartInfo& info : part_list()) {
      keys_.push_back(key_of(info, program_, options, logs_));
      result_.parts.push_back({&info, store_.find(std::string(info.id), keys_.back())});
    }
  }

  Result run() {
    const Clock::time_point start = Clock::now();
    try {
      make_parts();
    } catch (const Error& error) {
      result_.seconds = seconds_since(start);
      write_report();
      if (error.code() != ExitCode::kInterrupted) throw;
      throw Error(ExitCode::kInterrupted,
                  fmt::format("interrupted; {} of {} parts are made and kept, the same command goes on", made(),
                              result_.parts.size()));
    }
    result_.seconds = seconds_since(start);
    write_report();
    std::error_code ignored;  // what stays there is made use of or replaced by the next run
    if (!options_.keep_runs) fs::remove_all(options_.folder + "/work", ignored);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool is_wanted(const PartState& state) const {
    const auto& only = options_.only;
    const bool is_named = only.empty() || std::find(only.begin(), only.end(), state.info->id) != only.end();
    return is_named && (options_.force || !state.kept);
  }
  [[nodiscard]] double weight_of(const PartInfo& info) const {
    return info.weight_s + (logs_.empty() ? 0.0 : info.data_weight_s);
  }
  [[nodiscard]] std::size_t made() const {
    return static_cast<std::size_t>(std::count_if(result_.parts.begin(), result_.parts.end(),
                                                  [](const PartState& state) { return state.kept.has_value(); }));
  }

  void make_parts() {
    std::size_t count = 0;
    double total_s = 0.0;
    for (const PartState& state : result_.parts) {
      count += is_wanted(state) ? 1U : 0U;
      total_s += is_wanted(state) ? weight_of(*state.info) : 0.0;
    }
    Progress progress(count, total_s, options_.quiet);
    for (std::size_t k = 0; k < result_.parts.size(); ++k) {
      if (is_wanted(result_.parts[k])) make(result_.parts[k], keys_[k], progress);
    }
  }

  void make(PartState& state, const std::string& key, Progress& progress) {
    const std::string id(state.info->id);
    const Clock::time_point start = Clock::now();
    progress.begin(id, weight_of(*state.info));
    const Workplace place{.folder = store_.begin(id),
                          .drives = drives_,
                          .device = options_.device,
                          .graphics = options_.graphics,
                          .data = options_.data,
                          .progress = [&progress](double share) { progress.update(share); },
                          .stop = [] { return interrupted(); }};
    try {
      KeptPart kept{state.info->make(place), 0.0, utc_text()};
      if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
      kept.seconds = seconds_since(start);
      store_.keep(id, key, kept);
      state.kept = std::move(kept);
      state.is_new = true;
    } catch (...) {
      store_.drop(id);
      throw;
    }
    progress.finish(state.kept->seconds);
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
  Store store_;
  Drives drives_;
  std::vector<std::string> keys_;
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

Result reproduce(const Options& options) { return Reproduction(options).run(); }

}  // namespace gdtslam::reproduce
