// The program ffmpeg as a child: raw frames go in at its standard input, its film into a descriptor, what it complains
// of is kept. It has a process group of its own, so that Ctrl-C in a terminal comes to us alone. One object belongs to
// one thread.
#pragma once

#include <sys/types.h>

#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// A descriptor that is closed with its object.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept;
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { close(); }
  void close();
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_ = -1;
};

class FfmpegProcess {
 public:
  /// `arguments` follow the program's name; the child finds the film's descriptor as /dev/fd/3. Throws
  /// UnavailableError where the program cannot be run, also for want of descriptors or processes.
  FfmpegProcess(const std::string& program, std::vector<std::string> arguments, int film);
  FfmpegProcess(const FfmpegProcess&) = delete;
  FfmpegProcess& operator=(const FfmpegProcess&) = delete;
  /// Ends the child where it still runs.
  ~FfmpegProcess();

  /// False where the child no longer reads. Throws FileError, and Error (exit 130) where an interrupt came while it did
  /// not.
  bool write(std::string_view bytes);
  /// Ends the input and waits. Empty where the child ended well, else how it ended: "exit 1", "signal 9".
  std::string wait();
  /// The last lines that the child wrote to standard error, as one.
  [[nodiscard]] std::string complaint() const;

 private:
  void spawn(const std::string& program, std::vector<std::string> arguments, int input, int film);

  Descriptor input_;
  Descriptor errors_;
  pid_t child_ = -1;
};

}  // namespace gdtslam
