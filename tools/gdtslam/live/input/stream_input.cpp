// Standard input, a named pipe, a file: what ends by itself.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "engine/io/byte_source.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "live_input.hpp"

namespace gdtslam {
namespace {

// A named pipe whose writer has not come yet, too: each read waits for it.
int open_without_waiting(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_fifo(path, ignored)) return open_to_read(path);
  return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

class StreamInput final : public LiveInput {
 public:
  explicit StreamInput(const std::string& path) : name_(path == "-" ? "standard input" : path) {
    descriptor_ = path == "-" ? STDIN_FILENO : open_without_waiting(path);
    if (descriptor_ < 0) throw FileError(name_, "cannot be opened: " + errno_text(errno));
  }
  ~StreamInput() override {
    if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
  }

  std::size_t read(std::span<char> target) override {
    while (!is_over()) {
      if (!wait_for(descriptor_)) continue;
      const ssize_t count = ::read(descriptor_, target.data(), target.size());
      if (count >= 0) return static_cast<std::size_t>(count);
      if (errno != EINTR && errno != EAGAIN) throw FileError(name_, "cannot be read: " + errno_text(errno));
    }
    return 0;
  }
  [[nodiscard]] std::string name() const override { return name_; }

 private:
  std::string name_;
  int descriptor_ = -1;
};

}  // namespace

std::unique_ptr<LiveInput> open_stream(const std::string& path) { return std::make_unique<StreamInput>(path); }

}  // namespace gdtslam
