// gdtslam fleet submit: all portions, on this machine or by a scheduler.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <filesystem>
#include <memory>
#include <numeric>

#include "engine/io/did_you_mean.hpp"
#include "fleet.hpp"
#include "gdtslam/core/error.hpp"
#include "slurm.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"

namespace gdtslam {
namespace {

struct SubmitOptions {
  ComputeOptions compute;
  std::string engine;
  SlurmJobs jobs;
  std::string slurm_option;  ///< one that was given
};

int run_here(const SubmitOptions& options, const StoredPlan& stored) {
  const RunnerOptions& runner = options.compute.runner;
  const MostRefused most = parse_most_refused("--max-failed", options.compute.most_refused);
  std::vector<std::size_t> shards(stored.plan.shards.size());
  std::iota(shards.begin(), shards.end(), std::size_t{0});
  const RunnerOutcome outcome = run_shards(stored, shards, runner);
  const int code = judged(outcome, most, runner.atlas);
  const std::string text = finish_atlas(runner.atlas, false);
  if (!runner.quiet) {
    print_result(fmt::format("{} logs: {} mapped, {} refused{}\n{}", outcome.units, outcome.mapped, outcome.refused,
                             outcome.were_done > 0 ? fmt::format("; {} were done already", outcome.were_done) : "",
                             finish_text(text, runner.atlas)));
  }
  return code;
}

SlurmJobs jobs_of(const SubmitOptions& options, const StoredPlan& stored) {
  const ComputeOptions& compute = options.compute;
  SlurmJobs jobs = options.jobs;
  std::error_code failed;
  jobs.program = std::filesystem::read_symlink("/proc/self/exe", failed).string();
  if (failed) throw FileError("/proc/self/exe", "cannot be read: " + failed.message());
  jobs.atlas = std::filesystem::canonical(compute.runner.atlas).string();
  jobs.shards = stored.plan.shards.size();
  if (compute.runner.processes > 0) jobs.processors = compute.runner.processes;
  const DeviceOptions& device = compute.runner.device;
  if (device.device != DeviceOptions{}.device) jobs.arguments.insert(jobs.arguments.end(), {"--device", device.device});
  if (!device.isa.empty()) jobs.arguments.insert(jobs.arguments.end(), {"--isa", device.isa});
  if (compute.most_refused != ComputeOptions{}.most_refused)
    jobs.arguments.insert(jobs.arguments.end(), {"--max-failed", compute.most_refused});
  return jobs;
}

int submit(const SubmitOptions& options) {
  const std::vector<std::string> engines{"local", "slurm", "print"};
  const StoredPlan stored = read_plan(options.compute.runner.atlas);
  (void)parse_most_refused("--max-failed", options.compute.most_refused);
  if (options.engine == "local") {
    if (!options.slurm_option.empty())
      throw UsageError(options.slurm_option + ": is for Slurm; leave it out, or choose another --engine than local");
    return run_here(options, stored);
  }
  if (options.engine == "print") {
    print_result(printed_script(jobs_of(options, stored)));
  } else if (options.engine == "slurm") {
    const SlurmJobs jobs = jobs_of(options, stored);
    const std::vector<std::string> numbers = submit_slurm(jobs);
    if (!options.compute.runner.quiet)
      print_result(fmt::format("job {}: {} tasks, at most {} at a time\njob {}: finishes the atlas after them\n",
                               numbers[0], jobs.shards, jobs.at_most, numbers[1]));
  } else {
    throw UsageError(fmt::format("--engine: there is no '{}'{} (local, slurm or print)", options.engine,
                                 did_you_mean(options.engine, engines)));
  }
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_fleet_submit(CLI::App& fleet, CommandContext& context) {
  auto options = std::make_shared<SubmitOptions>();
  CLI::App* command = add_command(fleet, "submit", "All portions: on this machine, or by Slurm");
  add_atlas(*command, options->compute.runner.atlas);
  command
      ->add_option(
          "--engine", options->engine,
          "What runs the portions. local: this machine, then 'fleet finish'; slurm: a job array and a job after it;\n"
          "print: nothing, but the script that would submit them is printed")
      ->required()
      ->type_name("NAME");
  offer_words(command->get_option("--engine"), {"local", "slurm", "print"});
  add_compute_options(*command, options->compute);
  add_most_refused(*command, options->compute);
  SlurmJobs& jobs = options->jobs;
  command->add_option("--partition", jobs.partition, "Slurm: the partition [the cluster's]")->type_name("NAME");
  command->add_option("--mem", jobs.memory, "Slurm: memory of a task, for example 4G [the cluster's]")
      ->type_name("SIZE");
  command->add_option("--time", jobs.time, "Slurm: longest time of a task [the cluster's]")->type_name("TIME");
  add_count_option(*command, "--array-limit", jobs.at_most, 1, "Slurm: tasks at a time")->capture_default_str();
  add_count_option(*command, "--max-retries", jobs.retries, 0,
                   "Slurm: how often a task is tried again that ended for what its machine is to blame for")
      ->capture_default_str();
  command->add_flag("-q,--quiet", options->compute.runner.quiet, "Print errors only");
  command->footer(
      "With Slurm -j is the processors of a task (1 without it). The scripts are kept in ATLAS/slurm, and what the "
      "tasks\n"
      "print.\n"
      "\n"
      "Examples:\n"
      "  gdtslam fleet submit atlas --engine local\n"
      "  gdtslam fleet submit atlas --engine slurm --partition cpu --mem 4G --time 1:00:00 -j 4\n"
      "  gdtslam fleet submit atlas --engine print > jobs.sh");
  command->callback([options, command, &context] {
    for (const char* const name : {"--partition", "--mem", "--time", "--array-limit", "--max-retries"}) {
      if (command->count(name) > 0) options->slurm_option = name;
    }
    context.run = [options] { return submit(*options); };
    context.when_out_of_memory = "fewer at a time (-j) need less";
  });
}

}  // namespace gdtslam
