#include "live_input.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/io/byte_source.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "scan_queue.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

// A named pipe is opened before its writer exists: each read waits for the writer.
int open_without_waiting(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_fifo(path, ignored)) return open_to_read(path);
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

class StreamInput final : public LiveInput {
 public:
  explicit StreamInput(const std::string& path) : LiveInput(path == "-" ? "standard input" : path) {
    descriptor_ = path == "-" ? STDIN_FILENO : open_without_waiting(path);
    if (descriptor_ < 0) throw FileError(name(), "cannot be opened: " + errno_text(errno));
  }
  ~StreamInput() override {
    if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
  }

  std::size_t read(std::span<char> target) override {
    while (!is_over()) {
      if (!wait_for(descriptor_)) continue;
      const ssize_t count = ::read(descriptor_, target.data(), target.size());
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno != EINTR && errno != EAGAIN) throw FileError(name(), "cannot be read: " + errno_text(errno));
    }
    return 0;
  }

 private:
  int descriptor_ = -1;
};

/// A log that also reports what its input lost.
class ReportingLog final : public LogReader {
 public:
  ReportingLog(std::unique_ptr<LogReader> log, std::shared_ptr<LiveInput> input)
      : input_(std::move(input)), log_(std::move(log)) {}
  std::optional<LogRecord> next() override { return log_->next(); }
  [[nodiscard]] double progress() const override { return log_->progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override {
    warnings_ = log_->warnings();
    if (const std::uint64_t count = input_->half_lines(); count > 0) {
      warnings_.push_back({"half line of a sender that went away", count, input_->name()});
    }
    return warnings_;
  }

 private:
  std::shared_ptr<LiveInput> input_;  // outlives the log, which reads it
  std::unique_ptr<LogReader> log_;
  mutable std::vector<Warning> warnings_;
};

}  // namespace

bool LiveInput::is_over() const { return is_closed_ || interrupted(); }

bool LiveInput::wait_for(int descriptor, int most_ms) {
  pollfd waited{.fd = descriptor, .events = POLLIN, .revents = 0};
  return ::poll(&waited, 1, most_ms) > 0;
}

std::unique_ptr<LiveInput> open_stream(const std::string& path) { return std::make_unique<StreamInput>(path); }

LiveLog make_live_log(std::shared_ptr<LiveInput> input, std::size_t queue) {
  return [input = std::move(input), queue](const ReadOptions& options) -> std::unique_ptr<LogReader> {
    std::unique_ptr<LogReader> log =
        open_log_of_bytes([input](std::span<char> target) { return input->read(target); }, input->name(), options);
    if (queue > 0) {
      log = std::make_unique<ScanQueue>(
          std::move(log), queue, [] { return interrupted(); }, [input] { input->close(); });
    }
    return std::make_unique<ReportingLog>(std::move(log), input);
  };
}

}  // namespace gdtslam
