#include "input.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>
#include <vector>

#include "collect.hpp"
#include "engine/core/files/folder_calls.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/sha256.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/error.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBytes = std::size_t{1} << 18U;

std::vector<std::string> sorted_files_in(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code failed;
  for (const fs::path& entry : list_folder(folder, failed)) {
    if (fs::is_regular_file(entry)) files.push_back(entry.filename().string());
  }
  if (failed) throw FileError(folder, "cannot be read: " + failed.message());
  std::sort(files.begin(), files.end());
  return files;
}

std::map<std::string, std::optional<FileState>> states_of(const FleetPlan& plan, const std::string& log) {
  std::map<std::string, std::optional<FileState>> states;
  const auto add = [&states](const std::string& file) { states[file] = state_of_file(file); };
  std::error_code ignored;  // what cannot be asked about cannot be read either
  if (fs::is_directory(log, ignored)) {
    for (const std::string& file : sorted_files_in(log)) add(fmt::format("{}/{}", log, file));
  } else {
    add(log);
  }
  if (plan.linkage.empty()) add(sidecar_path(log, kLinkageSidecar));
  return states;
}

// A ROS 2 bag: its files by name.
HashedBytes hash_of_folder(const std::string& folder, const std::function<void()>& unless_stopped) {
  Sha256 hash;
  HashedBytes hashed;
  for (const std::string& file : sorted_files_in(folder)) {
    const HashedBytes part = sha256_of_file(fmt::format("{}/{}", folder, file), unless_stopped);
    hash.update(fmt::format("{} {}\n", part.sha256, file));
    hashed.bytes += part.bytes;
  }
  hashed.sha256 = hash.hex();
  return hashed;
}

// A log is a file or a ROS 2 bag. What else lies in its place, if only for a moment, is the machine's fault: a device
// has no end, and a bare folder is what a disk that is not there leaves.
void require_log(const std::string& log) {
  std::error_code failed;
  const fs::file_status status = fs::status(log, failed);
  if (fs::is_directory(status)) {
    if (!is_ros2_bag(log)) throw FileError(log, "is a folder without metadata.yaml: no log, and no ROS 2 bag");
  } else if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw FileError(log, "is no plain file");
  }
}

// The last part of an URI as a file's name, so that messages and pictures name the log.
std::string file_name_of_uri(const std::string& uri) {
  constexpr std::size_t kLongest = 100;
  std::string name = uri.substr(0, uri.find_first_of("?#"));
  name = name.substr(name.find_last_of('/') + 1);
  if (name.size() > kLongest) name = name.substr(name.size() - kLongest);
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!is_plain && c != '.' && c != '-' && c != '_') c = '_';
  }
  return name.empty() || name.front() == '.' ? "log" + name : name;
}

/// A shell command whose standard output is read. It and all that it starts are a session of their own, so that they
/// are ended together, and none of them stops as it asks a terminal that it is in the background of. The caller's
/// standard input is not theirs, and a pipe that breaks ends them as it does in a shell.
class OutputOfCommand {
 public:
  explicit OutputOfCommand(const std::string& command) : command_(command) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw FileError(command, "cannot be started: " + errno_text(errno));
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    std::array<std::string, 3> words{"sh", "-c", command};
    std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
    posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF);
    sigset_t defaults;
    ::sigemptyset(&defaults);
    ::sigaddset(&defaults, SIGPIPE);
    ::posix_spawnattr_setsigdefault(&attributes, &defaults);
    const int code = ::posix_spawn(&process_, "/bin/sh", &actions, &attributes, arguments.data(), environ);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    pipe_ = ends[0];
    if (code != 0) {
      ::close(pipe_);
      throw FileError(command, "cannot be started: " + errno_text(code));
    }
  }
  OutputOfCommand(const OutputOfCommand&) = delete;
  OutputOfCommand& operator=(const OutputOfCommand&) = delete;
  ~OutputOfCommand() {
    ::close(pipe_);
    if (process_ <= 0) return;
    ::kill(-process_, SIGTERM);
    constexpr std::chrono::seconds kToEnd{3};
    const auto last = std::chrono::steady_clock::now() + kToEnd;
    if (end([last] { return std::chrono::steady_clock::now() >= last; })) return;
    ::kill(-process_, SIGKILL);
    (void)end({});
  }
  /// 0 at its end, below 0 where a signal came, or nothing for a moment: a signal may also come just before the wait.
  ssize_t read(std::vector<char>& piece) const {
    constexpr int kLook_ms = 200;
    pollfd pipe{.fd = pipe_, .events = POLLIN, .revents = 0};
    if (::poll(&pipe, 1, kLook_ms) <= 0) return -1;
    const ssize_t count = ::read(pipe_, piece.data(), piece.size());
    if (count < 0 && errno != EINTR) throw FileError(command_, "cannot be read: " + errno_text(errno));
    return count;
  }
  /// Waits for its end. Throws LogUnavailable unless it ended with 0, and Error(kInterrupted).
  void require_done(const std::function<bool()>& stop) {
    const std::optional<int> status = end(stop);
    if (!status) throw Error(ExitCode::kInterrupted, "interrupted");
    if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0) return;
    throw LogUnavailable({command_, WIFSIGNALED(*status) ? fmt::format("was ended by signal {}", WTERMSIG(*status))
                                                         : fmt::format("ended with code {}", WEXITSTATUS(*status))});
  }

 private:
  /// How it ended; nothing where `stop` came first.
  std::optional<int> end(const std::function<bool()>& stop) {
    constexpr std::chrono::milliseconds kLook{10};
    int status = 0;
    for (;;) {
      const pid_t ended = ::waitpid(process_, &status, stop ? WNOHANG : 0);
      if (ended > 0 || (ended < 0 && errno != EINTR)) break;
      if (stop && stop()) return std::nullopt;
      if (stop) std::this_thread::sleep_for(kLook);
    }
    process_ = 0;
    return status;
  }
  std::string command_;
  pid_t process_ = 0;
  int pipe_ = -1;
};

// Whether a shell would take the letter at that place for one of a quoted text.
bool is_in_quotes(std::string_view command, std::size_t place) {
  char open = '\0';
  for (std::size_t at = 0; at < place; ++at) {
    const char c = command[at];
    if (c == '\\' && open != '\'') {
      if (++at >= place) return true;
    } else if (open == '\0' && (c == '\'' || c == '"' || c == '`')) {
      open = c;
    } else if (c == open) {
      open = '\0';
    }
  }
  return open != '\0';
}

HashedBytes fetch(const std::string& command, const std::string& file, const std::function<bool()>& stop) {
  OutputOfCommand output(command);
  AtomicFile written(file);
  Sha256 hash;
  HashedBytes hashed;
  std::vector<char> piece(kReadBytes);
  for (ssize_t count = 1; count != 0;) {
    if (stop && stop()) throw Error(ExitCode::kInterrupted, "interrupted");
    count = output.read(piece);
    if (count <= 0) continue;
    const std::string_view text(piece.data(), static_cast<std::size_t>(count));
    hash.update(text);
    written.write(text);
    hashed.bytes += text.size();
  }
  output.require_done(stop);
  written.commit();
  hashed.sha256 = hash.hex();
  return hashed;
}

// Nothing is written, so that a file that fails is the log's own or lies beside it.
HashedBytes hash_in_its_place(const FleetPlan& plan, const std::function<bool()>& stop, UnitInput& input) {
  const auto unless_stopped = [&stop] {
    if (stop && stop()) throw Error(ExitCode::kInterrupted, "interrupted");
  };
  try {
    require_log(input.path);
    input.files = states_of(plan, input.path);
    const std::string linkage = plan.linkage.empty() ? linkage_sidecar(input.path) : std::string();
    if (!linkage.empty()) input.linkage_sha256 = sha256_of_file(linkage).sha256;
    std::error_code ignored;  // what cannot be asked about cannot be read either
    return fs::is_directory(input.path, ignored) ? hash_of_folder(input.path, unless_stopped)
                                                 : sha256_of_file(input.path, unless_stopped);
  } catch (const FileError& error) {
    throw LogUnavailable(error);
  }
}

}  // namespace

UnitInput unit_input(const FleetPlan& plan, const FleetUnit& unit, const std::string& folder,
                     const std::function<bool()>& stop) {
  UnitInput input{.path = unit.uri, .bytes = 0, .sha256 = {}, .linkage_sha256 = {}};
  HashedBytes hashed;
  if (has_scheme(unit.uri)) {
    input.path = folder + "/" + file_name_of_uri(unit.uri);
    hashed = fetch(get_command(plan.get, unit.uri), input.path, stop);
  } else {
    hashed = hash_in_its_place(plan, stop, input);
  }
  input.bytes = hashed.bytes;
  input.sha256 = std::move(hashed.sha256);
  return input;
}

void require_unchanged(const FleetPlan& plan, const UnitInput& input) {
  if (input.files.empty()) return;
  const auto files = states_of(plan, input.path);
  const auto [before, now] = std::mismatch(input.files.begin(), input.files.end(), files.begin(), files.end());
  if (before == input.files.end() && now == files.end()) return;
  const bool is_one_file = before != input.files.end() && now != files.end() && before->first == now->first;
  throw LogUnavailable(
      {is_one_file ? before->first : input.path, "was changed while it was mapped; run the command again"});
}

std::string unit_name(const FleetPlan& plan, const UnitInput& input) {
  Sha256 hash;
  const auto add = [&hash](std::string_view text) { hash.update(fmt::format("{}:", text.size())).update(text); };
  add("gdtslam unit");
  add(plan.program.version);
  add(plan.program.sample_map_sha256);
  add(plan.program.sample_trajectory_sha256);
  add(plan.config);
  for (const auto* list : {&plan.reading.topics, &plan.reading.mounts}) {
    add(fmt::format("{}", list->size()));
    for (const std::string& text : *list) add(text);
  }
  add(plan.reading.odometry);
  add(plan.reading.crank);
  add(plan.reading.lenient ? "lenient" : "strict");
  add(plan.linkage);
  add(input.linkage_sha256);
  add(input.sha256);
  return hash.hex().substr(0, 16);
}

std::string get_command(const std::string& get, const std::string& uri) {
  std::size_t place = get.find("{}");
  if (place == std::string::npos)
    throw UsageError(
        fmt::format("--get: {} needs a command with {{}} in the place of the URI, for example --get 'aws s3 cp {{}} -'",
                    in_quotes(uri)));
  std::string quoted = "'";
  for (const char c : uri) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  quoted += "'";
  std::string command;
  std::size_t begin = 0;
  for (; place != std::string::npos; place = get.find("{}", begin)) {
    // Within quotes of the command the URI's own quotes would end those, and its text would be the shell's.
    if (is_in_quotes(get, place))
      throw UsageError(fmt::format("--get: {{}} stands within quotes in {}; the URI gets its own, so write it bare",
                                   in_quotes(get)));
    command += get.substr(begin, place - begin) + quoted;
    begin = place + 2;
  }
  return command + get.substr(begin);
}

}  // namespace gdtslam
