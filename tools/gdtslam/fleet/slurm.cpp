#include "slurm.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "engine/core/ascii.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/programs.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace gdtslam {
namespace {

constexpr const char* kArrayScript = "/slurm/run.sh";
constexpr const char* kFinishScript = "/slurm/finish.sh";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += ' ' + shell_quoted(word);
  return text;
}

// What both jobs ask of the cluster.
void add_common(const SlurmJobs& jobs, std::vector<std::string>& arguments) {
  if (!jobs.partition.empty()) arguments.push_back("--partition=" + jobs.partition);
  if (!jobs.memory.empty()) arguments.push_back("--mem=" + jobs.memory);
  if (!jobs.time.empty()) arguments.push_back("--time=" + jobs.time);
}

// Where what a job prints goes: a % of the folder is none of Slurm's, which \ would take from all of them.
std::string output_argument(const SlurmJobs& jobs, const std::string& file) {
  if (jobs.atlas.find('\\') != std::string::npos)
    throw UsageError(in_quotes(jobs.atlas) + ": Slurm takes no file below a folder with a \\ in its name; rename it");
  std::string folder;
  for (const char c : jobs.atlas) folder += c == '%' ? std::string("%%") : std::string(1, c);
  return fmt::format("--output={}/slurm/{}", folder, file);
}

// Its standard output without the last line end.
std::string output_of(const std::vector<std::string>& words) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw Error(ExitCode::kFailed, words.front() + ": " + errno_text(errno));
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  ::posix_spawn_file_actions_addclose(&actions, ends[0]);
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  arguments.reserve(copies.size() + 1);
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = 0;
  const std::string program = program_of_path(words.front());
  const int code =
      program.empty() ? ENOENT : ::posix_spawn(&process, program.c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  constexpr std::size_t kMostBytes = std::size_t{64} << 10U;
  std::string text;
  std::array<char, 4096> piece{};
  for (ssize_t count = 1; code == 0 && count != 0 && text.size() <= kMostBytes;) {
    count = ::read(ends[0], piece.data(), piece.size());
    if (count > 0) text.append(piece.data(), static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) break;
  }
  ::close(ends[0]);
  if (code != 0) throw Error(ExitCode::kFailed, words.front() + " cannot be started: " + errno_text(code));
  if (text.size() > kMostBytes) ::kill(process, SIGKILL);  // it may print for ever, whoever reads
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (text.size() > kMostBytes) throw Error(ExitCode::kFailed, words.front() + " prints more than the number of a job");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(ExitCode::kFailed,
                words.front() + " failed; what it says stands above; the scripts are kept in the atlas");
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

// "123" of "123;cluster".
std::string job_of(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "sbatch");
  const std::string said = output_of(arguments);
  std::string job = said.substr(0, said.find(';'));
  if (!is_digits(job)) throw Error(ExitCode::kFailed, "sbatch named no job, but " + in_quotes(said));
  return job;
}

}  // namespace

std::string shell_quoted(const std::string& text) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_./=%:,+@";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

// A node that fails gives its task back by itself (--requeue); a task that ends with 1, 74 or a signal does so here.
std::string array_script(const SlurmJobs& jobs) {
  return fmt::format(
      "#!/bin/sh\n"
      "# A task of a job array of Slurm: one portion of the atlas.\n"
      "{1} fleet run {0} --shard auto{2}\n"
      "code=$?\n"
      "case $code in 0|2|65|69|70|78) exit $code ;; esac\n"
      "# The machine is to blame: once more, perhaps on another one.\n"
      "if [ \"${{SLURM_RESTART_COUNT:-0}}\" -lt {3} ]; then\n"
      "  scontrol requeue \"${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}\" && sleep 60\n"
      "fi\n"
      "exit $code\n",
      shell_quoted(jobs.atlas), shell_quoted(jobs.program), joined(jobs.arguments), jobs.retries);
}

std::string finish_script(const SlurmJobs& jobs) {
  return fmt::format(
      "#!/bin/sh\n"
      "# Once all portions are done.\n"
      "exec {} fleet finish {}\n",
      shell_quoted(jobs.program), shell_quoted(jobs.atlas));
}

std::vector<std::string> array_arguments(const SlurmJobs& jobs) {
  std::vector<std::string> arguments{"--parsable",
                                     "--job-name=gdtslam-fleet",
                                     "--requeue",
                                     "--open-mode=append",
                                     fmt::format("--array=0-{}%{}", jobs.shards - 1, jobs.at_most),
                                     fmt::format("--cpus-per-task={}", jobs.processors),
                                     output_argument(jobs, "%A_%a.txt")};
  add_common(jobs, arguments);
  arguments.push_back(jobs.atlas + kArrayScript);
  return arguments;
}

std::vector<std::string> finish_arguments(const SlurmJobs& jobs, const std::string& array) {
  std::vector<std::string> arguments{"--parsable", "--job-name=gdtslam-finish", "--dependency=afterok:" + array,
                                     "--kill-on-invalid-dep=yes", output_argument(jobs, "finish.txt")};
  add_common(jobs, arguments);
  arguments.push_back(jobs.atlas + kFinishScript);
  return arguments;
}

std::string printed_script(const SlurmJobs& jobs) {
  // A name within the text may have lines, and none of them may end it.
  const auto here = [](const std::string& file, const std::string& text) {
    std::string end = "SCRIPT";
    while (text.find(end) != std::string::npos) end += '_';
    return fmt::format("cat > {0} <<'{2}'\n{1}{2}\n", shell_quoted(file), text, end);
  };
  const std::vector<std::string> finish = finish_arguments(jobs, "");
  std::string after = joined(finish);
  const std::string place = "--dependency=afterok:";
  after.replace(after.find(place), place.size(), place + "\"$array\"");
  return fmt::format("#!/bin/sh\nset -e\nmkdir -p {}\n", shell_quoted(jobs.atlas + "/slurm")) +
         here(jobs.atlas + kArrayScript, array_script(jobs)) + here(jobs.atlas + kFinishScript, finish_script(jobs)) +
         fmt::format("array=$(sbatch{})\narray=${{array%%;*}}\nsbatch{}\n", joined(array_arguments(jobs)), after);
}

std::vector<std::string> submit_slurm(const SlurmJobs& jobs) {
  if (program_of_path("sbatch").empty())
    throw UnavailableError(
        "--engine slurm: there is no sbatch here; submit from a machine of the cluster, or --engine print");
  const std::vector<std::string> arguments = array_arguments(jobs);
  make_folder(jobs.atlas + "/slurm");
  write_file_atomically(jobs.atlas + kArrayScript, array_script(jobs));
  write_file_atomically(jobs.atlas + kFinishScript, finish_script(jobs));
  const std::string array = job_of(arguments);
  try {
    return {array, job_of(finish_arguments(jobs, array))};
  } catch (const Error& error) {
    throw Error(error.code(),
                fmt::format("{}; job {} is submitted and runs, but nothing comes after it: once it is done, "
                            "'gdtslam fleet finish {}'",
                            error.what(), array, shell_quoted(jobs.atlas)));
  }
}

}  // namespace gdtslam
