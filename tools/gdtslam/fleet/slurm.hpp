// Jobs for Slurm: the scripts of an array of shards and of what comes after it, and how they are handed over.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gdtslam {

struct SlurmJobs {
  std::string program;  ///< absolute
  std::string atlas;    ///< absolute
  std::string partition;
  std::string memory;  ///< of a task, as sbatch takes it; empty: the cluster's default
  std::string time;    ///< likewise
  std::size_t shards = 1;
  std::size_t at_most = 64;              ///< tasks at a time
  std::size_t processors = 1;            ///< of a task
  std::size_t retries = 3;               ///< of a task that ended for what its machine is to blame for
  std::vector<std::string> arguments{};  ///< of `fleet run`, besides ATLAS and --shard
};

/// Text in single quotes for a shell.
std::string shell_quoted(const std::string& text);

/// The script of a task of the array, and of the job after the array.
std::string array_script(const SlurmJobs& jobs);
std::string finish_script(const SlurmJobs& jobs);

/// The arguments of sbatch for either; `array` is the number of the array's job.
std::vector<std::string> array_arguments(const SlurmJobs& jobs);
std::vector<std::string> finish_arguments(const SlurmJobs& jobs, const std::string& array);

/// A shell script that does what submit_slurm() does.
std::string printed_script(const SlurmJobs& jobs);

/// Writes the scripts to ATLAS/slurm and hands them to sbatch; returns the two jobs' numbers. Throws UnavailableError
/// where there is no sbatch, Error where it fails, which names the first job where that was taken; FileError.
std::vector<std::string> submit_slurm(const SlurmJobs& jobs);

}  // namespace gdtslam
