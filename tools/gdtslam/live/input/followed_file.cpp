// A file that grows.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <thread>

#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "live_input.hpp"
#include "whole_lines.hpp"

namespace gdtslam {
namespace {

class FollowedFile final : public LiveInput {
 public:
  explicit FollowedFile(const std::string& path) : path_(path) {
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0) throw FileError(path_, "cannot be opened: " + errno_text(errno));
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) {
      ::close(descriptor_);
      throw FileError(path_, "is no file that could grow; what is a pipe is read without --follow");
    }
    // Where the system tells of no changes the file is looked at again and again.
    changes_ = ::inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
    if (changes_ >= 0) ::inotify_add_watch(changes_, path.c_str(), IN_MODIFY);
  }
  ~FollowedFile() override {
    ::close(descriptor_);
    if (changes_ >= 0) ::close(changes_);
  }

  std::size_t read(std::span<char> target) override {
    while (lines_.is_empty()) {
      if (is_over()) {
        if (lines_.drop_rest()) count_half_line();
        return 0;
      }
      if (!take_what_is_there()) wait_for_more();
    }
    return lines_.take(target);
  }
  [[nodiscard]] std::string name() const override { return path_; }

 private:
  bool take_what_is_there() {
    const ssize_t count = ::read(descriptor_, block_.data(), block_.size());
    if (count < 0 && errno != EINTR) throw FileError(path_, "cannot be read: " + errno_text(errno));
    if (count <= 0) return false;
    lines_.add({block_.data(), static_cast<std::size_t>(count)});
    position_ += count;
    return true;
  }

  void wait_for_more() {
    struct stat status {};
    if (::fstat(descriptor_, &status) == 0 && status.st_size < position_) {
      throw InputError({path_, 0}, fmt::format("has become shorter than the {} bytes that were read of it", position_));
    }
    if (changes_ < 0) return std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (!wait_for(changes_)) return;
    while (::read(changes_, block_.data(), block_.size()) > 0) {
    }
  }

  std::string path_;
  int descriptor_ = -1;
  int changes_ = -1;
  off_t position_ = 0;
  WholeLines lines_;
  std::array<char, std::size_t{1} << 16U> block_{};
};

}  // namespace

std::unique_ptr<LiveInput> follow_file(const std::string& path) { return std::make_unique<FollowedFile>(path); }

}  // namespace gdtslam
