// gdtslam verify: the same bits on the CPU and on a device, for every kernel and for whole logs.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_report.hpp"
#include "gdtslam/core/error.hpp"
#include "run.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kMostRandom = 10'000'000;
constexpr std::size_t kDigestShown = 12;

struct VerifyCommand {
  VerifyOptions options;
  std::string write_expected;
  bool force = false;
  bool json = false;
};

std::string plural(std::uint64_t count, const char* noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

std::string device_text(const DeviceInfo& device) {
  return fmt::format("{} ({}, {})", device.name, device.kind, device.driver);
}

std::string kernels_text(const TargetReport& target) {
  if (target.kernels.empty()) return {};
  std::string text =
      fmt::format("{:<20} {:>8} {:>13} {:>11} {:>11}\n", "kernel", "cases", "values", "different", "largest");
  for (const KernelVerdict& kernel : target.kernels) {
    text += fmt::format("{:<20} {:>8} {:>13} {:>11} {:>11}", kernel.kernel, kernel.cases, kernel.values,
                        kernel.different, kernel.largest);
    if (kernel.faults > 0) text += "  " + plural(kernel.faults, "other failure");
    text += kernel.first.empty() ? "\n" : "  first: " + kernel.first + "\n";
  }
  return text;
}

std::string work_text(const TargetReport& target) {
  if (!target.is_vulkan || target.kernels.empty()) return {};
  return fmt::format(
      "the device's own work: {} dispatches in {} submissions; {} of {} kernels right without their CPU functions\n",
      target.work.dispatches, target.work.submissions, target.work.decoys, target.kernels.size());
}

std::string log_text(const LogVerdict& log, bool is_vulkan) {
  std::string text =
      fmt::format("{}, {}{}: {}, map {}, trajectory {}", log.task.log.substr(log.task.log.rfind('/') + 1),
                  log.task.matcher, log.task.with_loops ? ", loops closed" : "", plural(log.found.scans, "scan"),
                  log.found.map_sha256.substr(0, kDigestShown), log.found.trajectory_sha256.substr(0, kDigestShown));
  if (!log.found.cloud_sha256.empty()) text += ", cloud " + log.found.cloud_sha256.substr(0, kDigestShown);
  if (log.faults.empty()) text += log.task.expected ? ": equal, and as shipped" : ": equal";
  for (const std::string& fault : log.faults) text += "; DIFFERENT: " + fault;
  text += fmt::format("\n    {:.2f} s on the CPU, {:.2f} s here", log.reference.wall_s, log.found.wall_s);
  if (is_vulkan && log.found.dispatches > 0) {
    text += fmt::format("; {} dispatches in {} submissions", log.found.dispatches, log.found.submissions);
  } else if (is_vulkan) {
    text += "; this matcher asks the device for nothing";
  }
  return text + "\n";
}

// The last line, for people and for `tail -1` in a script.
std::string verdict_text(const VerifyReport& report) {
  const std::string found = plural(report.differences(), "difference");
  if (report.failure) return fmt::format("FAIL: {} failed; {} until then\n", report.targets.back().name, found);
  if (report.error)
    return fmt::format("FAIL: {} was not verified to its end; {} until then\n", report.targets.back().name, found);
  return fmt::format("{}: {}\n", report.passed() ? "PASS" : "FAIL", found);
}

std::string as_text(const VerifyReport& report) {
  std::string text;
  for (const TargetReport& target : report.targets) {
    const bool was_opened = !target.device.name.empty();
    text += fmt::format("{}: {} against {}\n", target.name, was_opened ? device_text(target.device) : "not opened",
                        device_text(report.reference));
    text += kernels_text(target) + work_text(target);
    if (!target.failure.empty()) text += "FAILED: " + target.failure + "\n";
    for (const LogVerdict& log : target.logs) text += log_text(log, target.is_vulkan);
    if (!target.error.empty()) text += "ENDED: " + target.error + "\n";
    text += "\n";
  }
  return text + fmt::format("{:.1f} s\n", report.wall_s) + verdict_text(report);
}

Json kernel_json(const KernelVerdict& kernel) {
  return {{"kernel", kernel.kernel},
          {"cases", kernel.cases},
          {"values", kernel.values},
          {"different", kernel.different},
          {"largest", kernel.largest},
          {"faults", kernel.faults},
          {"first", kernel.first.empty() ? Json() : Json(kernel.first)}};
}

Json run_json(const LogRun& run) {
  return {{"map_sha256", run.map_sha256},
          {"trajectory_sha256", run.trajectory_sha256},
          {"cloud_sha256", run.cloud_sha256.empty() ? Json() : Json(run.cloud_sha256)},
          {"dispatches", run.dispatches},
          {"submissions", run.submissions},
          {"copy_equal", run.copy_is_equal},
          {"wall_s", run.wall_s}};
}

Json log_json(const LogVerdict& log) {
  return {{"log", log.task.log},
          {"matcher", log.task.matcher},
          {"loops", log.task.with_loops},
          {"scans", log.found.scans},
          {"shipped", log.task.expected.has_value()},
          {"reference", run_json(log.reference)},
          {"device", run_json(log.found)},
          {"faults", log.faults}};
}

Json target_json(const TargetReport& target) {
  Json kernels = Json::array();
  for (const KernelVerdict& kernel : target.kernels) kernels.push_back(kernel_json(kernel));
  Json logs = Json::array();
  for (const LogVerdict& log : target.logs) logs.push_back(log_json(log));
  const std::string& failure = target.failure.empty() ? target.error : target.failure;
  return {{"name", target.name},
          {"device", target.device.name.empty() ? Json() : device_json(target.device)},
          {"failure", failure.empty() ? Json() : Json(failure)},
          {"dispatches", target.work.dispatches},
          {"submissions", target.work.submissions},
          {"decoys", target.work.decoys},
          {"kernels", kernels},
          {"logs", logs},
          {"differences", target.differences()}};
}

Json as_json(const VerifyReport& report) {
  Json targets = Json::array();
  for (const TargetReport& target : report.targets) targets.push_back(target_json(target));
  return {{"version", GDTSLAM_VERSION}, {"reference", device_json(report.reference)}, {"targets", targets},
          {"wall_s", report.wall_s},    {"differences", report.differences()},        {"passed", report.passed()}};
}

int verify(const VerifyCommand& command) {
  if (!command.write_expected.empty()) {
    WrittenFiles({}, command.force).add("--write-expected", command.write_expected);
    write_expected_results(command.options, command.write_expected);
    return static_cast<int>(ExitCode::kDone);
  }
  const VerifyReport report = run_verify(command.options);
  print_result(command.json ? json_text(as_json(report)) : as_text(report));
  if (report.failure) throw DeviceError(*report.failure);
  if (report.error) std::rethrow_exception(report.error);
  if (report.passed()) return static_cast<int>(ExitCode::kDone);
  throw Error(ExitCode::kFailed, fmt::format("{}: {} from {}", report.targets.front().name,
                                             plural(report.differences(), "difference"), report.reference.name));
}

void add_case_options(CLI::App& command, VerifyCommand& chosen) {
  VerifyOptions& options = chosen.options;
  command
      .add_option("filter", options.filter,
                  "Only kernels whose name contains this, and no logs; 'logs': the logs and no kernels")
      ->type_name("NAME");
  command.add_option("--random", options.random_cases, "Number of random cases beside the standard ones")
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(CLI::Range(0U, kMostRandom))
      ->capture_default_str();
  add_count_option(command, "--seed", options.seed, 0, "Seed of the random cases")->capture_default_str();
  command.add_flag("--large", options.large, "The largest sizes too, which take minutes on a slow device");
  command.add_option("--log", options.logs, "Map this log too, beside the sample log; may be repeated")
      ->type_name("LOG")
      ->allow_extra_args(false);
  add_recording_options(command, options.recording);
  command
      .add_option("--write-expected", chosen.write_expected,
                  "Only map the sample log on the CPU, or nodding-start where FILE is named after it, and write what\n"
                  "it gives as what it must give; for a change of gdtslam that is meant to change results")
      ->type_name("FILE");
  add_force_option(command, chosen.force);
}

}  // namespace

void add_verify_command(CLI::App& app, CommandContext& context) {
  auto chosen = std::make_shared<VerifyCommand>();
  CLI::App* command = add_command(app, "verify", "The same bits on the CPU and on a device: every kernel, whole logs");
  add_case_options(*command, *chosen);
  add_device_options(*command, chosen->options.device, false);
  command->add_flag("--json", chosen->json, "Print JSON");
  command->add_flag("-q,--quiet", chosen->options.quiet, "Draw no progress");
  command->footer(
      "Every kernel runs on the CPU and on the device, on the cases of the project's tests; then the sample log is\n"
      "mapped with the matchers " +
      fmt::format("{}", fmt::join(verified_matchers(), " and ")) +
      " on both, and once as map does,\n"
      "with its loops closed; so is a log of a laser that nods, with its cloud. All must give the shipped hashes, "
      "too.\n"
      "That the device did it itself is shown: no CPU kernel runs meanwhile, and each kernel runs once without its "
      "CPU\n"
      "functions. --device cpu compares the CPU's instruction sets and threads with the baseline, or those alone that\n"
      "--isa and --threads name.\n"
      "The last line is PASS (exit 0) or FAIL (1: differences, or the device failed; that of the error where a log\n"
      "cannot be mapped) with the number of differences; with --json, 'passed'. Exit 69: there is no such device or\n"
      "instruction set.\n"
      "\n"
      "Examples:\n"
      "  gdtslam verify --device vulkan\n"
      "  gdtslam verify --device vulkan:1 --random 10000 --log intel.clf.gz\n"
      "  gdtslam verify pose_cost --json");
  command->callback([chosen, &context] { context.run = [chosen] { return verify(*chosen); }; });
}

}  // namespace gdtslam
