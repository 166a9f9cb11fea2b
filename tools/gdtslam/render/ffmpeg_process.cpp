#include "ffmpeg_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <utility>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

constexpr int kFilmOfChild = 3;
constexpr int kPipeBytes = 1 << 20;  // what Linux grants everyone: ffmpeg can compress while a frame is drawn
constexpr std::size_t kMostComplaint = 300;
// A signal may be handled by another thread, or just before a call that blocks, which goes on then: so none blocks for
// longer than this before it is asked whether there was one.
constexpr int kGlance_ms = 20;

[[noreturn]] void fail_to_start(const std::string& program, int code) {
  const bool is_limit = code == EMFILE || code == ENFILE || code == EAGAIN;
  throw UnavailableError(
      fmt::format("{}: cannot be run: {}; {}", program, errno_text(code),
                  is_limit ? "raise the limit ('ulimit -a' shows it)" : "--ffmpeg names another one"));
}

// What a child needs, and how its start fails where there is not enough of something.
class Start {
 public:
  explicit Start(const std::string& program) : program_(program) {
    check(::posix_spawn_file_actions_init(&files));
    check(::posix_spawnattr_init(&attributes));
  }
  Start(const Start&) = delete;
  Start& operator=(const Start&) = delete;
  ~Start() {
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
  }
  void check(int code) const {
    if (code != 0) fail_to_start(program_, code);
  }
  // The child's descriptor `number`, by way of a copy beyond the numbers that the child gets, so that giving it one
  // does not overwrite another.
  void give(int descriptor, int number) {
    constexpr int kFirstFree = 10;
    const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, kFirstFree);
    if (copy < 0) fail_to_start(program_, errno == EINVAL ? EMFILE : errno);  // EINVAL: the limit is below kFirstFree
    copies_.emplace_back(copy);
    check(::posix_spawn_file_actions_adddup2(&files, copy, number));
  }

  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};

 private:
  const std::string& program_;
  std::vector<Descriptor> copies_;
};

}  // namespace

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  close();
  number_ = std::exchange(other.number_, -1);
  return *this;
}

void Descriptor::close() {
  if (number_ >= 0) ::close(std::exchange(number_, -1));
}

FfmpegProcess::FfmpegProcess(const std::string& program, std::vector<std::string> arguments, int film) {
  errors_ = Descriptor(::memfd_create("ffmpeg", MFD_CLOEXEC));
  if (errors_.number() < 0) fail_to_start(program, errno);
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) fail_to_start(program, errno);
  const Descriptor output(ends[0]);
  input_ = Descriptor(ends[1]);
  if (::fcntl(input_.number(), F_SETFL, O_NONBLOCK) != 0) fail_to_start(program, errno);
  ::fcntl(input_.number(), F_SETPIPE_SZ, kPipeBytes);  // smaller where the user's share of pipes is used up
  spawn(program, std::move(arguments), output.number(), film);
}

void FfmpegProcess::spawn(const std::string& program, std::vector<std::string> arguments, int input, int film) {
  Start start(program);
  start.give(input, STDIN_FILENO);
  start.check(::posix_spawn_file_actions_addopen(&start.files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0));
  start.give(errors_.number(), STDERR_FILENO);
  start.give(film, kFilmOfChild);
  sigset_t defaults{};
  ::sigemptyset(&defaults);
  ::sigaddset(&defaults, SIGPIPE);
  start.check(::posix_spawnattr_setsigdefault(&start.attributes, &defaults));
  start.check(::posix_spawnattr_setpgroup(&start.attributes, 0));
  start.check(::posix_spawnattr_setflags(&start.attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP));
  arguments.insert(arguments.begin(), program);
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const int code = ::posix_spawn(&child_, program.c_str(), &start.files, &start.attributes, words.data(), ::environ);
  if (code == 0) return;
  child_ = -1;
  fail_to_start(program, code);
}

FfmpegProcess::~FfmpegProcess() {
  if (child_ <= 0) return;
  ::kill(child_, SIGKILL);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

namespace {

/// Holds SIGPIPE back on this thread and takes away what came meanwhile, so that a program that is gone shows as EPIPE
/// whether or not the process ignores the signal.
class NoBrokenPipeSignal {
 public:
  NoBrokenPipeSignal() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  NoBrokenPipeSignal(const NoBrokenPipeSignal&) = delete;
  NoBrokenPipeSignal& operator=(const NoBrokenPipeSignal&) = delete;
  ~NoBrokenPipeSignal() {
    const timespec now{};
    while (::sigtimedwait(&pipe_, nullptr, &now) == SIGPIPE) {
    }
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t pipe_{};
  sigset_t before_{};
};

}  // namespace

bool FfmpegProcess::write(std::string_view bytes) {
  const NoBrokenPipeSignal quiet;
  while (!bytes.empty()) {
    const ssize_t count = ::write(input_.number(), bytes.data(), bytes.size());
    if (count >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EPIPE) {
      return false;
    } else if (errno != EINTR && errno != EAGAIN) {
      throw FileError("the pipe to ffmpeg", "cannot be written: " + errno_text(errno));
    }
    if (bytes.empty()) break;
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
    pollfd room{.fd = input_.number(), .events = POLLOUT, .revents = 0};
    ::poll(&room, 1, kGlance_ms);
  }
  return true;
}

std::string FfmpegProcess::wait() {
  input_.close();
  int status = 0;
  pid_t ended = 0;
  while ((ended = ::waitpid(child_, &status, WNOHANG)) <= 0) {
    if (ended < 0 && errno != EINTR)
      throw Error(ExitCode::kFailed, "ffmpeg: cannot be waited for: " + errno_text(errno));
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
    ::poll(nullptr, 0, kGlance_ms);
  }
  child_ = -1;
  if (WIFSIGNALED(status)) return fmt::format("signal {}", WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? std::string() : fmt::format("exit {}", WEXITSTATUS(status));
}

std::string FfmpegProcess::complaint() const {
  constexpr off_t kMostRead = 4096;
  const off_t size = ::lseek(errors_.number(), 0, SEEK_END);
  if (size <= 0) return {};
  std::string text(static_cast<std::size_t>(std::min(size, kMostRead)), '\0');
  const ssize_t count = ::pread(errors_.number(), text.data(), text.size(), std::max<off_t>(0, size - kMostRead));
  text.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::string line;
  for (const char letter : text) {
    if (letter == '\n') {
      line += "; ";
    } else {
      line += letter;
    }
  }
  if (line.size() > kMostComplaint) line = "..." + line.substr(line.size() - kMostComplaint);
  return one_line(line, kMostComplaint + 3);
}

}  // namespace gdtslam
