#include "ffmpeg_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/message_text.hpp"
#include "interrupt.hpp"

namespace gdtslam {
namespace {

constexpr int kFilmOfChild = 3;
constexpr int kPipeBytes = 1 << 20;  // what Linux grants everyone: ffmpeg can compress while a frame is drawn
constexpr std::size_t kMostComplaint = 300;

[[noreturn]] void fail(const std::string& what, int code) {
  throw Error(ExitCode::kFailed, fmt::format("ffmpeg: {}: {}", what, std::generic_category().message(code)));
}

// A copy beyond the numbers that the child gets, so that giving it one does not overwrite another.
Descriptor raised(int number) {
  constexpr int kFirstFree = 10;
  const int copy = ::fcntl(number, F_DUPFD_CLOEXEC, kFirstFree);
  if (copy < 0) fail("no descriptor is free", errno);
  return Descriptor(copy);
}

void check(int code, const char* what) {
  if (code != 0) fail(what, code);
}

struct Actions {
  Actions() {
    check(::posix_spawn_file_actions_init(&files), "cannot be started");
    check(::posix_spawnattr_init(&attributes), "cannot be started");
  }
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;
  ~Actions() {
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
  }
  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
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
  if (errors_.number() < 0) fail("cannot be started", errno);
  int ends[2] = {-1, -1};
  if (::pipe2(ends, O_CLOEXEC) != 0) fail("cannot be started", errno);
  const Descriptor output(ends[0]);
  input_ = Descriptor(ends[1]);
  ::fcntl(input_.number(), F_SETPIPE_SZ, kPipeBytes);  // smaller where the user's share of pipes is used up
  spawn(program, std::move(arguments), output.number(), film);
}

void FfmpegProcess::spawn(const std::string& program, std::vector<std::string> arguments, int input, int film) {
  Actions actions;
  const Descriptor safe_input = raised(input);
  const Descriptor safe_errors = raised(errors_.number());
  const Descriptor safe_film = raised(film);
  check(::posix_spawn_file_actions_adddup2(&actions.files, safe_input.number(), STDIN_FILENO), "cannot be started");
  check(::posix_spawn_file_actions_addopen(&actions.files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0),
        "cannot be started");
  check(::posix_spawn_file_actions_adddup2(&actions.files, safe_errors.number(), STDERR_FILENO), "cannot be started");
  check(::posix_spawn_file_actions_adddup2(&actions.files, safe_film.number(), kFilmOfChild), "cannot be started");
  sigset_t defaults{};
  ::sigemptyset(&defaults);
  ::sigaddset(&defaults, SIGPIPE);
  check(::posix_spawnattr_setsigdefault(&actions.attributes, &defaults), "cannot be started");
  check(::posix_spawnattr_setpgroup(&actions.attributes, 0), "cannot be started");
  check(::posix_spawnattr_setflags(&actions.attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP),
        "cannot be started");
  arguments.insert(arguments.begin(), program);
  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const int code =
      ::posix_spawn(&child_, program.c_str(), &actions.files, &actions.attributes, words.data(), ::environ);
  if (code == 0) return;
  child_ = -1;
  throw UnavailableError(
      fmt::format("{}: cannot be run: {}; --ffmpeg names another one", program, std::generic_category().message(code)));
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
    } else if (errno != EINTR) {
      fail("cannot be written to", errno);
    }
    if (!bytes.empty() && interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
  }
  return true;
}

std::string FfmpegProcess::wait() {
  input_.close();
  int status = 0;
  while (::waitpid(child_, &status, 0) < 0) {
    if (errno != EINTR) fail("cannot be waited for", errno);
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
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
