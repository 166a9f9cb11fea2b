#include "run.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "engine/mapping/match/matchers.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/folders.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kLogsFilter = "logs";
constexpr unsigned kOtherThreads = 3;  // its slices of a launch end elsewhere than those of one thread

/// A backend to verify, opened when its turn comes.
struct Target {
  std::string name;
  Proof proof = Proof::kNone;
  bool with_logs = true;
  std::function<std::unique_ptr<Backend>()> open;
};

/// The CPU's targets; only the named instruction set or threads if given. Throws UsageError and UnavailableError.
std::vector<Target> cpu_targets(const DeviceOptions& options) {
  const CpuOptions named = cpu_options(options);
  const std::unique_ptr<Backend> tried = make_cpu_backend(named);
  const unsigned threads = options.are_threads_given ? tried->device().threads : kOtherThreads;
  std::vector<Target> targets;
  for (const Isa isa : {Isa::kAvx2, Isa::kAvx512}) {
    if (!isa_available(isa) || isa != named.isa.value_or(isa)) continue;
    targets.push_back({"cpu " + std::string(to_string(isa)), Proof::kNone, true,
                       [isa] { return make_cpu_backend({.threads = 1, .isa = isa}); }});
  }
  targets.push_back({"cpu, " + std::to_string(threads) + (threads == 1 ? " thread" : " threads"), Proof::kNone,
                     targets.empty(),

                     [threads, isa = named.isa] { return make_cpu_backend({.threads = threads, .isa = isa}); }});
  return targets;
}

std::vector<KernelCaseSource> chosen_cases(const VerifyOptions& options) {
  std::vector<KernelCaseSource> all = kernel_cases();
  for (KernelCaseSource& source : random_kernel_cases(options.seed, options.random_cases)) {
    all.push_back(std::move(source));
  }
  std::erase_if(all, [&options](const KernelCaseSource& source) {
    return (source.large && !options.large) || source.kernel->name.find(options.filter) == std::string_view::npos;
  });
  return all;
}

std::vector<LogTask> chosen_logs(const VerifyOptions& options) {
  if (!options.filter.empty() && options.filter != kLogsFilter) return {};
  std::vector<LogTask> tasks;
  for (const SampleLog& sample : sample_logs()) {
    for (const ExpectedRun& run : sample.runs) tasks.push_back({sample.path, run.matcher, run.with_loops, run, {}});
  }
  if (options.logs.empty() && options.recording.are_stated()) {
    throw UsageError("verify: --topic, --odom, --crank and --mount are for a --log");
  }
  LogConfig config;
  state_recording(options.recording, config);
  const ReadOptions read = read_options_of(config, false);
  for (const std::string& log : options.logs) {
    open_log(log, read);  // report an unreadable log before the kernels, which take a while
    for (const std::string& matcher : verified_matchers()) tasks.push_back({log, matcher, false, std::nullopt, read});
  }
  return tasks;
}

/// Runs the cases and logs of the command line on the targets.
class Verification {
 public:
  explicit Verification(const VerifyOptions& options)
      : options_(options), cases_(chosen_cases(options)), logs_(chosen_logs(options)) {
    if (cases_.empty() && logs_.empty()) {
      throw UsageError("verify: no kernel's name contains '" + options.filter + "' ('logs' verifies the logs alone)");
    }
  }

  /// If this throws, `report` has the findings so far.
  void verify(const Target& target, Backend& reference, TargetReport& report) {
    report.name = target.name;
    report.is_vulkan = target.proof == Proof::kDeviceDidIt;
    const std::unique_ptr<Backend> device = target.open();
    report.device = device->device();
    verify_kernels(target, reference, *device, report);
    if (!target.with_logs) return;
    for (const LogTask& task : logs_) report.logs.push_back(verify_log(task, target, reference, *device));
  }

 private:
  void verify_kernels(const Target& target, Backend& reference, Backend& device, TargetReport& report) {
    ProgressLine progress("cases, " + target.name, options_.quiet);
    KernelVerifier verifier(reference, device, target.proof);
    for (std::size_t k = 0; k < cases_.size(); ++k) {
      if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is kept of this verification");
      verifier.check(cases_[k].make());
      progress.update(k + 1, static_cast<double>(k + 1) / static_cast<double>(cases_.size()));
    }
    verifier.finish();
    report.kernels = verifier.verdicts();
    report.work = verifier.work();
  }

  LogVerdict verify_log(const LogTask& task, const Target& target, Backend& reference, Backend& device) {
    const auto key = std::make_tuple(task.log, task.matcher, task.with_loops);
    if (!references_.contains(key)) references_[key] = run(task, "cpu", reference);
    return judge(task, references_[key], run(task, target.name, device));
  }

  LogRun run(const LogTask& task, const std::string& name, Backend& backend) {
    ProgressLine progress("scans, " + task.matcher + " on " + name, options_.quiet);
    return run_log(task, backend, [&progress](std::uint64_t scans, double share) { progress.update(scans, share); });
  }

  const VerifyOptions& options_;
  std::vector<KernelCaseSource> cases_;
  std::vector<LogTask> logs_;
  std::map<std::tuple<std::string, std::string, bool>, LogRun> references_;  ///< by log, matcher and loops
};

}  // namespace

std::vector<std::string> verified_matchers() {
  std::vector<std::string> names;
  for (const MatcherInfo& matcher : matchers()) {
    if (matcher.follows_slope) names.emplace_back(matcher.name);
  }
  return names;
}

std::uint64_t TargetReport::cases() const {
  std::uint64_t sum = 0;
  for (const KernelVerdict& kernel : kernels) sum += kernel.cases;
  return sum;
}

std::uint64_t TargetReport::differences() const {
  std::uint64_t sum = 0;
  for (const KernelVerdict& kernel : kernels) sum += kernel.differences();
  for (const LogVerdict& log : logs) sum += log.faults.size();
  return sum;
}

std::uint64_t VerifyReport::differences() const {
  std::uint64_t sum = 0;
  for (const TargetReport& target : targets) sum += target.differences();
  return sum;
}

VerifyReport run_verify(const VerifyOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  VerifyReport report;
  std::vector<Target> targets;
  std::unique_ptr<Backend> reference;
  if (const std::unique_ptr<VulkanBackend> device = make_vulkan(options.device)) {
    DeviceOptions named = options.device;
    named.device = "vulkan:" + std::to_string(device->vulkan_device().index);
    targets.push_back({named.device, Proof::kDeviceDidIt, true, [named] { return make_vulkan(named, {}); }});
    reference = make_cpu(options.device);
  } else {
    targets = cpu_targets(options.device);
    reference = make_cpu_backend({.threads = 1, .isa = Isa::kBaseline});
  }
  report.reference = reference->device();
  Verification verification(options);
  for (const Target& target : targets) {
    TargetReport& part = report.targets.emplace_back();
    try {
      verification.verify(target, *reference, part);
    } catch (const DeviceError& error) {
      part.failure = error.what();
      report.failure = error;
      break;
    } catch (const std::exception& error) {
      if (interrupted()) throw;
      part.error = error.what();
      report.error = std::current_exception();
      break;
    }
  }
  report.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

void write_expected_results(const VerifyOptions& options, const std::string& path) {
  const std::unique_ptr<Backend> cpu = make_cpu(options.device);
  const std::string nodding = nodding_sample_log_file();
  const auto stem = [](const std::string& file) {
    const std::string name = std::filesystem::path(file).filename().string();
    return name.substr(0, name.find('.'));
  };
  const bool nods = stem(path) == stem(nodding);
  const std::string log = nods ? nodding : sample_log_file();
  std::vector<ExpectedRun> runs;
  const auto add = [&](const std::string& matcher, bool with_loops) {
    const LogRun run = run_log({log, matcher, with_loops, std::nullopt}, *cpu, [](std::uint64_t, double) {});
    runs.push_back({matcher, with_loops, run.scans, run.map_sha256, run.trajectory_sha256, run.cloud_sha256});
  };
  if (!nods) {
    for (const std::string& matcher : verified_matchers()) add(matcher, false);
  }
  add(std::string(to_string(MatchConfig{}.matcher)), true);
  write_expected(path, log, runs);
}

}  // namespace gdtslam
