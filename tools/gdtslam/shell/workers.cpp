#include "workers.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>

#include "console.hpp"
#include "engine/core/memory/out_of_memory.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using WorkJson = nlohmann::json;

// Sends one line of JSON. A failed write is not reported: the parent sees that the process ends.
void send(int pipe, const WorkJson& message) {
  const std::string line = message.dump(-1, ' ', false, WorkJson::error_handler_t::replace) + "\n";
  std::size_t sent = 0;
  while (sent < line.size()) {
    const ssize_t count = ::write(pipe, line.data() + sent, line.size() - sent);
    if (count < 0 && errno != EINTR) return;
    sent += count > 0 ? static_cast<std::size_t>(count) : 0U;
  }
}

// Sends progress often enough for a line on a terminal.
Workers::Tell teller(int pipe) {
  using Clock = std::chrono::steady_clock;
  return [pipe, last = Clock::time_point{}](double share) mutable {
    const Clock::time_point now = Clock::now();
    if (now - last < std::chrono::milliseconds(100)) return;
    last = now;
    send(pipe, {{"share", share}});
  };
}

constexpr const char* kFewerAtATime = "; fewer at a time need less";

WorkJson run_work(const Workers::Work& work, int pipe) {
  try {
    return {{"result", work(teller(pipe))}};
  } catch (const OutOfMemory& error) {
    return {{"error", std::string(error.what()) + kFewerAtATime},
            {"code", static_cast<int>(error.code())},
            {"memory", true}};
  } catch (const Error& error) {
    return {{"error", error.what()}, {"code", static_cast<int>(error.code())}};
  } catch (const std::bad_alloc&) {
    return {{"error", std::string("out of memory") + kFewerAtATime},
            {"code", static_cast<int>(ExitCode::kFailed)},
            {"memory", true}};
  } catch (const std::exception& error) {
    return {{"error", error.what()}, {"code", static_cast<int>(ExitCode::kFailed)}};
  }
}

// Memory can run out inside a noexcept function; the parent reports it.
[[noreturn]] void end_silently_without_memory() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    ::_exit(static_cast<int>(ExitCode::kFailed));
  } catch (...) {
    std::abort();
  }
  std::abort();
}

// Ends with the parent, however that ends. Nothing is thrown from here, because the callers on the stack are the
// parent's.
[[noreturn]] void live_as_child(const Workers::Work& work, pid_t parent, int pipe) noexcept {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  std::set_terminate(end_silently_without_memory);
  if (::getppid() == parent) send(pipe, run_work(work, pipe));
  ::_exit(0);
}

double to_seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

Error system_error(const char* call) {
  return {ExitCode::kFailed,
          fmt::format("a process for the work cannot be started: {}: {}", call, std::strerror(errno))};
}

constexpr int kLook_ms = 200;  // a signal may come between the check of its flag and the wait

}  // namespace

Workers::~Workers() {
  for (const Process& process : running_) ::kill(process.pid, SIGTERM);
  for (const Process& process : running_) {
    ::close(process.pipe);
    while (::waitpid(process.pid, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

void Workers::start(std::size_t id, const Work& work) {
  running_.reserve(running_.size() + 1);  // after the process starts, nothing may fail before it is listed
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw system_error("pipe2");
  std::fflush(nullptr);  // else the child would print it again
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid == 0) live_as_child(work, parent, ends[1]);
  ::close(ends[1]);
  if (pid < 0) {
    ::close(ends[0]);
    throw system_error("fork");
  }
  running_.push_back({.id = id, .pid = pid, .pipe = ends[0], .text = {}});
}

void Workers::take_lines(Process& process) {
  for (std::size_t end = 0; (end = process.text.find('\n')) != std::string::npos;) {
    const std::string line = process.text.substr(0, end);
    process.text.erase(0, end + 1);
    const WorkJson message = WorkJson::parse(line);
    if (message.contains("share")) {
      process.share = message.at("share").get<double>();
    } else {
      process.outcome = line;
    }
  }
}

Workers::Event Workers::make_event(const Process& process, double cpu_s, int status) {
  Event event{.id = process.id, .share = 1.0, .cpu_s = cpu_s, .result = {}};
  if (process.outcome.empty()) {
    const std::string how =
        WIFSIGNALED(status) ? fmt::format(" by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status))) : "";
    event.failure = {.code = ExitCode::kFailed,
                     .message = "the process that worked on it was ended" + how + "; the same command goes on",
                     .by_signal = true};
    return event;
  }
  const WorkJson outcome = WorkJson::parse(process.outcome);
  if (outcome.contains("error")) {
    event.failure = {.code = static_cast<ExitCode>(outcome.at("code").get<int>()),
                     .message = outcome.at("error").get<std::string>(),
                     .for_memory = outcome.contains("memory")};
  } else {
    event.result = outcome.at("result").get<std::string>();
  }
  return event;
}

// The outcome is held back until the process ends, because only then its CPU time is known.
Workers::Event Workers::ended(std::size_t place) {
  const Process process = running_[place];
  running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(place));
  ::close(process.pipe);
  int status = 0;
  rusage usage{};
  while (::wait4(process.pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  return make_event(process, to_seconds(usage.ru_utime) + to_seconds(usage.ru_stime), status);
}

Workers::Event Workers::wait_for_any() {
  for (;;) {
    if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted");
    std::vector<pollfd> pipes;
    pipes.reserve(running_.size());
    for (const Process& process : running_) pipes.push_back({.fd = process.pipe, .events = POLLIN, .revents = 0});
    if (::poll(pipes.data(), pipes.size(), kLook_ms) <= 0) continue;
    for (std::size_t k = 0; k < pipes.size(); ++k) {
      if (pipes[k].revents == 0) continue;
      std::array<char, 4096> bytes{};
      const ssize_t count = ::read(pipes[k].fd, bytes.data(), bytes.size());
      if (count == 0) return ended(k);
      if (count < 0) continue;
      Process& process = running_[k];
      process.text.append(bytes.data(), static_cast<std::size_t>(count));
      take_lines(process);
      return {.id = process.id, .share = process.share, .cpu_s = 0.0, .result = {}};
    }
  }
}

}  // namespace gdtslam
