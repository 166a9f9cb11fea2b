#include "film_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/clouds/cloud_words.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/programs.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

// Another thread may handle a signal, or it may come just before a blocking call, so no call blocks for longer.
constexpr int kGlance_ms = 20;

void throw_if_interrupted() {
  if (interrupted()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
}

/// The program ffmpeg as a child: it reads raw frames from its standard input, and its messages are kept. It has its
/// own process group, so that Ctrl-C in a terminal reaches only this process.
class Ffmpeg {
 public:
  /// Throws UnavailableError if the program cannot be run.
  explicit Ffmpeg(std::vector<std::string> command) : errors_(::memfd_create("ffmpeg", MFD_CLOEXEC)) {
    int ends[2] = {-1, -1};
    int code = errors_ < 0 || ::pipe2(ends, O_CLOEXEC) != 0 ? errno : 0;
    input_ = ends[1];
    posix_spawn_file_actions_t files{};
    posix_spawnattr_t attributes{};
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_adddup2(&files, ends[0], STDIN_FILENO);
    ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files, errors_, STDERR_FILENO);
    ::posix_spawnattr_init(&attributes);
    sigset_t defaults{};
    ::sigemptyset(&defaults);
    ::sigaddset(&defaults, SIGPIPE);
    ::posix_spawnattr_setsigdefault(&attributes, &defaults);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    std::vector<char*> words;
    words.reserve(command.size() + 1);
    for (std::string& word : command) words.push_back(word.data());
    words.push_back(nullptr);
    if (code == 0) code = ::posix_spawn(&child_, words[0], &files, &attributes, words.data(), ::environ);
    ::posix_spawn_file_actions_destroy(&files);
    ::posix_spawnattr_destroy(&attributes);
    if (ends[0] >= 0) ::close(ends[0]);
    if (code == 0) {
      ::fcntl(input_, F_SETFL, O_NONBLOCK);
      return;
    }
    ::close(input_);
    ::close(errors_);
    throw UnavailableError(fmt::format("{}: cannot be run: {}", command.front(), errno_text(code)));
  }

  Ffmpeg(const Ffmpeg&) = delete;
  Ffmpeg& operator=(const Ffmpeg&) = delete;
  /// Ends the child if it still runs.
  ~Ffmpeg() {
    if (child_ > 0) {
      ::kill(child_, SIGKILL);
      while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
    if (input_ >= 0) ::close(input_);
    ::close(errors_);
  }

  /// False if the child no longer reads. Throws Error (exit 130) if an interrupt came during the wait.
  bool write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t count = ::write(input_, bytes.data(), bytes.size());
      if (count >= 0) {
        bytes.remove_prefix(static_cast<std::size_t>(count));
        continue;
      }
      if (errno == EPIPE) return false;
      if (errno != EINTR && errno != EAGAIN) {
        throw FileError("the pipe to ffmpeg", "cannot be written: " + errno_text(errno));
      }
      throw_if_interrupted();
      pollfd room{.fd = input_, .events = POLLOUT, .revents = 0};
      ::poll(&room, 1, kGlance_ms);
    }
    return true;
  }

  /// Ends the input and waits. Returns an empty text on success, else how the child ended: "exit 1", "signal 9".
  std::string wait() {
    ::close(std::exchange(input_, -1));
    int status = 0;
    while (::waitpid(child_, &status, WNOHANG) <= 0) {
      throw_if_interrupted();
      ::poll(nullptr, 0, kGlance_ms);
    }
    child_ = -1;
    if (WIFSIGNALED(status)) return fmt::format("signal {}", WTERMSIG(status));
    return WEXITSTATUS(status) == 0 ? std::string() : fmt::format("exit {}", WEXITSTATUS(status));
  }

  /// The last lines that the child wrote to standard error, as one.
  [[nodiscard]] std::string complaint() const {
    constexpr std::size_t kMostComplaint = 300;
    const off_t size = ::lseek(errors_, 0, SEEK_END);
    std::string text(kMostComplaint, '\0');
    const auto from = std::max<off_t>(0, size - static_cast<off_t>(kMostComplaint));
    const ssize_t count = ::pread(errors_, text.data(), text.size(), from);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, count)));
    while (text.ends_with('\n')) text.pop_back();
    std::replace(text.begin(), text.end(), '\n', ';');
    return one_line((from > 0 ? "..." : "") + text, kMostComplaint + 3);
  }

 private:
  int input_ = -1;
  int errors_ = -1;
  pid_t child_ = -1;
};

// Red, green and blue of opaque pixels.
std::string to_rgb(const RgbaImage& frame) {
  std::string rgb(frame.pixels.size() / 4 * 3, '\0');
  for (std::size_t from = 0, to = 0; from < frame.pixels.size(); from += 4, to += 3) {
    std::copy_n(frame.pixels.begin() + static_cast<std::ptrdiff_t>(from), 3,
                rgb.begin() + static_cast<std::ptrdiff_t>(to));
  }
  return rgb;
}

// Highest bit rate: 2.8 Mbit/s at 1280x720 and up to 25 frames a second, 7 MB in 20 s. Larger and faster films need
// more, but less for each pixel and frame.
long kilobits_per_s(const FilmTarget& target) {
  constexpr double kRate = 2800.0;
  constexpr double kPixels = 1280.0 * 720.0;
  constexpr double kUsualFramesPerSecond = 25.0;
  const double pixels = static_cast<double>(target.width) * static_cast<double>(target.height) / kPixels;
  const double frames = std::max(target.frames_per_s / kUsualFramesPerSecond, 1.0);
  return std::max(200L, std::lround(kRate * std::sqrt(pixels * frames) * std::sqrt(std::sqrt(pixels * frames))));
}

std::vector<std::string> ffmpeg_command(const FilmTarget& target, const std::string& file) {
  std::string text = fmt::format(
      "-hide_banner -nostdin -loglevel error -y -f rawvideo -pixel_format rgb24 -video_size {}x{} -framerate {} -i "
      "pipe:0 -an ",
      target.width, target.height, target.frames_per_s);
  if (target.kind == FilmKind::kGif) {
    // One palette for the whole film, chosen by the moving parts; ordered dithering, which does not flicker between
    // frames.
    text +=
        "-filter_complex split[a][b];[a]palettegen=stats_mode=diff[p];"
        "[b][p]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle -loop 0 -f gif";
  } else {
    // 4:2:0 in HD colours with the index first, which every browser and player can play during download. Appearing
    // points are noise to an encoder: without a limit 20 s of them take 50 MB.
    text += fmt::format(
        "-vf scale=out_color_matrix=bt709:out_range=tv -c:v libx264 -preset medium -crf 20 -maxrate {0}k -bufsize {1}k "
        "-pix_fmt yuv420p ",
        kilobits_per_s(target), 2 * kilobits_per_s(target));
    text += "-colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv -movflags +faststart -f mp4";
  }
  text += " -map_metadata -1 -fflags +bitexact -flags:v +bitexact";
  std::vector<std::string> command{program_of_path("ffmpeg")};
  if (command.front().empty()) {
    throw UnavailableError(
        "a film needs the program ffmpeg, and no absolute folder of PATH has it; install the package ffmpeg, or write "
        "frames into a folder (-o frames/)");
  }
  for (const std::string_view word : split_words(text)) command.emplace_back(word);
  command.push_back("file:" + file);
  return command;
}

class FfmpegFilm : public FilmWriter {
 public:
  explicit FfmpegFilm(const FilmTarget& target)
      : path_(target.path), file_(target.path), ffmpeg_(ffmpeg_command(target, file_.written_path())) {}

  void add(const RgbaImage& frame) override {
    if (!ffmpeg_.write(to_rgb(frame))) fail(ffmpeg_.wait());
  }
  void finish() override {
    const std::string failure = ffmpeg_.wait();
    if (!failure.empty()) fail(failure);
    if (fs::file_size(file_.written_path()) == 0) fail("exit 0, but no film");
    file_.commit();
  }

 private:
  [[noreturn]] void fail(const std::string& how) const {
    const std::string complaint = ffmpeg_.complaint();
    for (const char* const disk : {"No space left on device", "File too large"}) {
      if (complaint.find(disk) != std::string::npos) {
        throw FileError(path_, "cannot be written: ffmpeg says: " + complaint);
      }
    }
    throw Error(ExitCode::kFailed, fmt::format("ffmpeg failed ({}){}{}", how.empty() ? "it stopped reading" : how,
                                               complaint.empty() ? "" : ": ", complaint));
  }

  std::string path_;
  AtomicFile file_;
  Ffmpeg ffmpeg_;
};

class FrameFolder : public FilmWriter {
 public:
  explicit FrameFolder(std::string folder) : folder_(std::move(folder)) { make_folder(folder_); }

  void add(const RgbaImage& frame) override {
    write_file_atomically(frame_path(folder_, count_++), encode_png(frame.width, frame.height, frame.pixels));
  }
  void finish() override {
    for (std::size_t k = count_; fs::is_regular_file(frame_path(folder_, k)); ++k) {
      std::error_code failed;
      fs::remove(frame_path(folder_, k), failed);
      if (failed) throw FileError(frame_path(folder_, k), "of an earlier film cannot be removed: " + failed.message());
    }
  }

 private:
  std::string folder_;
  std::size_t count_ = 0;
};

}  // namespace

std::string frame_path(const std::string& folder, std::size_t k) {
  return (fs::path(folder) / fmt::format("frame-{:04}.png", k + 1)).string();
}

std::unique_ptr<FilmWriter> open_film(const FilmTarget& target) {
  if (target.kind == FilmKind::kFrames) return std::make_unique<FrameFolder>(target.path);
  if (target.kind == FilmKind::kMp4 && (target.width % 2 != 0 || target.height % 2 != 0)) {
    throw UsageError(fmt::format("--size {}x{}: an .mp4 needs even numbers, for example {}x{}", target.width,
                                 target.height, target.width + target.width % 2, target.height + target.height % 2));
  }
  constexpr double kMostGifFramesPerSecond = 50.0;  // a .gif counts hundredths, and players slow down a frame of one
  if (target.kind == FilmKind::kGif && target.frames_per_s > kMostGifFramesPerSecond) {
    throw UsageError(fmt::format("--fps {}: a .gif shows at most {} frames a second; an .mp4 can show more",
                                 target.frames_per_s, kMostGifFramesPerSecond));
  }
  return std::make_unique<FfmpegFilm>(target);
}

}  // namespace gdtslam
