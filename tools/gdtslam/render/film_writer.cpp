#include "film_writer.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/clouds/cloud_words.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/io/message_text.hpp"
#include "ffmpeg_process.hpp"
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/shell/programs.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCopyBytes = std::size_t{1} << 20U;

// Red, green and blue of pixels that nothing shines through.
std::string rgb_of(const RgbaImage& frame) {
  std::string rgb(frame.pixels.size() / 4 * 3, '\0');
  for (std::size_t from = 0, to = 0; from < frame.pixels.size(); from += 4, to += 3) {
    rgb[to] = static_cast<char>(frame.pixels[from]);
    rgb[to + 1] = static_cast<char>(frame.pixels[from + 1]);
    rgb[to + 2] = static_cast<char>(frame.pixels[from + 2]);
  }
  return rgb;
}

void require_size(const FilmTarget& target, const RgbaImage& frame) {
  if (frame.width == target.width && frame.height == target.height) return;
  throw Error(ExitCode::kFailed, fmt::format("a frame has {}x{} pixels, the film {}x{}", frame.width, frame.height,
                                             target.width, target.height));
}

// A file beside the film's that has no name, so that nothing is left whatever happens.
Descriptor nameless_file(const std::string& beside) {
  const std::string folder = fs::path(beside).has_parent_path() ? fs::path(beside).parent_path().string() : ".";
  constexpr mode_t kOwnerOnly = 0600;
  const int direct = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, kOwnerOnly);
  if (direct >= 0) return Descriptor(direct);
  std::string name = folder + "/.gdtslam-film-XXXXXX";  // file systems without O_TMPFILE
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named < 0) throw FileError(beside, "cannot be created: " + errno_text(errno));
  ::unlink(name.c_str());
  return Descriptor(named);
}

// The most that a film may take: 2.8 Mbit/s at 1280x720 and up to 25 frames a second, 7 MB in 20 s; more for more
// pixels and frames, of which each needs less.
long kilobits_per_s(const FilmTarget& target) {
  constexpr double kRate = 2800.0;
  constexpr double kPixels = 1280.0 * 720.0;
  constexpr double kFramesPerSecond = 25.0;
  const double pixels = static_cast<double>(target.width) * static_cast<double>(target.height) / kPixels;
  const double frames = std::max(target.frames_per_s / kFramesPerSecond, 1.0);
  return std::max(200L, std::lround(kRate * std::sqrt(pixels * frames) * std::sqrt(std::sqrt(pixels * frames))));
}

std::vector<std::string> arguments_of(const FilmTarget& target) {
  std::string text = fmt::format(
      "-hide_banner -nostdin -loglevel error -y -f rawvideo -pixel_format rgb24 -video_size {}x{} -framerate {} -i "
      "pipe:0 "
      "-an ",
      target.width, target.height, target.frames_per_s);
  if (target.kind == OutputKind::kGif) {
    // One palette for the whole film, from what moves; ordered dithering, which does not flicker from frame to frame.
    text +=
        "-filter_complex split[a][b];[a]palettegen=stats_mode=diff[p];"
        "[b][p]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle -loop 0 -f gif";
  } else {
    // 4:2:0 in the colours of HD, the index first: what every browser and player plays while it loads. Points that
    // appear are noise to an encoder: without a limit 20 s of them take 50 MB.
    text += fmt::format(
        "-vf scale=out_color_matrix=bt709:out_range=tv -c:v libx264 -preset medium -crf 20 -maxrate {0}k -bufsize {1}k "
        "-pix_fmt yuv420p ",
        kilobits_per_s(target), 2 * kilobits_per_s(target));
    text += "-colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv -movflags +faststart -f mp4";
  }
  text += " -map_metadata -1 -fflags +bitexact -flags:v +bitexact /dev/fd/3";
  const std::vector<std::string_view> words = words_of(text);
  return {words.begin(), words.end()};
}

class FfmpegFilm : public FilmWriter {
 public:
  FfmpegFilm(const FilmTarget& target, const std::string& program)
      : target_(target),
        file_(target.path),
        film_(nameless_file(target.path)),
        process_(program, arguments_of(target), film_.number()) {}

  void add(const RgbaImage& frame) override {
    require_size(target_, frame);
    if (!process_.write(rgb_of(frame))) fail(process_.wait());
  }

  void finish() override {
    const std::string failure = process_.wait();
    if (!failure.empty()) fail(failure);
    if (copy() == 0) fail("exit 0, but no film");
    file_.commit();
  }

 private:
  [[noreturn]] void fail(const std::string& how) const {
    const std::string complaint = process_.complaint();
    const auto complains_of = [&complaint](const char* text) { return complaint.find(text) != std::string::npos; };
    if (complains_of("No space left on device") || complains_of("File too large")) {
      throw FileError(target_.path, "cannot be written: ffmpeg says: " + complaint);
    }
    if (complains_of("Unknown encoder")) {
      throw UnavailableError("ffmpeg cannot make this film: " + complaint + "; install the package ffmpeg in full");
    }
    if (complains_of("Too many open files") || complains_of("error while loading shared libraries")) {
      throw UnavailableError("ffmpeg cannot run: " + complaint);
    }
    throw Error(ExitCode::kFailed, fmt::format("ffmpeg failed ({}){}{}", how.empty() ? "it stopped reading" : how,
                                               complaint.empty() ? "" : ": ", complaint));
  }

  std::size_t copy() {
    std::string piece(kCopyBytes, '\0');
    std::size_t done = 0;
    for (;;) {
      const ssize_t count = ::pread(film_.number(), piece.data(), piece.size(), static_cast<off_t>(done));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throw FileError(target_.path, "cannot be written: " + errno_text(errno));
      if (count == 0) return done;
      file_.write(std::string_view(piece.data(), static_cast<std::size_t>(count)));
      done += static_cast<std::size_t>(count);
    }
  }

  FilmTarget target_;
  AtomicFile file_;
  Descriptor film_;
  FfmpegProcess process_;
};

class FrameFolder : public FilmWriter {
 public:
  explicit FrameFolder(const FilmTarget& target) : target_(target) {
    const fs::path folder = fs::path(frame_path(target.path, 0)).parent_path();
    if (!folder.empty()) make_folder(folder.string());
  }

  void add(const RgbaImage& frame) override {
    require_size(target_, frame);
    write_file_atomically(frame_path(target_.path, count_++), encode_png(frame.width, frame.height, frame.pixels));
  }

  void finish() override { remove_frames_beyond(); }

 private:
  // An earlier film was longer: its last frames are no part of this one. They follow without a gap and look as this
  // program's frames of this size do; other pictures that the pattern fits are somebody's.
  void remove_frames_beyond() const {
    const RgbaImage blank(target_.width, target_.height);
    const std::string own = encode_png(blank.width, blank.height, blank.pixels);
    for (std::size_t k = count_;; ++k) {
      const std::string path = frame_path(target_.path, k);
      if (!begins_as(path, own)) return;
      std::error_code failed;
      fs::remove(path, failed);
      if (failed) throw FileError(path, "a frame of an earlier film cannot be removed: " + failed.message());
    }
  }

  // The header, and that pixels follow: cameras and editors write more than that. How many bytes of pixels there are
  // differs from frame to frame.
  static bool begins_as(const std::string& path, std::string_view png) {
    constexpr std::size_t kPngHeaderBytes = 33;
    constexpr std::size_t kNameAt = 37;  // of the chunk behind it
    constexpr std::size_t kNameEnd = 41;
    std::error_code ignored;
    if (!fs::is_regular_file(fs::symlink_status(path, ignored))) return false;
    std::string begin(kNameEnd, '\0');
    std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
    return begin.substr(0, kPngHeaderBytes) == png.substr(0, kPngHeaderBytes) &&
           begin.substr(kNameAt) == png.substr(kNameAt, kNameEnd - kNameAt);
  }

  FilmTarget target_;
  std::size_t count_ = 0;
};

// Where the number of a pattern begins and ends, and its digits; nothing where there is no such thing.
struct PatternNumber {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t digits = 0;
};
bool next_number(const std::string& text, std::size_t from, PatternNumber& number) {
  for (std::size_t k = text.find('%', from); k != std::string::npos; k = text.find('%', k + 1)) {
    std::size_t end = k + 1;
    std::size_t digits = 0;
    while (end < text.size() && text[end] >= '0' && text[end] <= '9' && digits < 100) {
      digits = 10 * digits + static_cast<std::size_t>(text[end++] - '0');
    }
    if (end < text.size() && text[end] == 'd') {
      number = {k, end + 1, digits};
      return true;
    }
  }
  return false;
}

}  // namespace

bool is_frame_pattern(const std::string& text) {
  PatternNumber number;
  return next_number(text, 0, number);
}

std::string frame_path(const std::string& target, std::size_t k) {
  PatternNumber number;
  if (!next_number(target, 0, number)) return (fs::path(target) / fmt::format("frame-{:04}.png", k + 1)).string();
  PatternNumber second;
  constexpr std::size_t kMostDigits = 9;
  if (next_number(target, number.end, second) || number.digits > kMostDigits || !target.ends_with(".png")) {
    throw UsageError(fmt::format("'{}' is no pattern for frames; one number and .png, as in frames/f%04d.png", target));
  }
  return target.substr(0, number.begin) + fmt::format("{:0{}}", k + 1, std::max<std::size_t>(1, number.digits)) +
         target.substr(number.end);
}

std::string find_ffmpeg(const std::string& given) {
  if (given.find('/') != std::string::npos) {
    std::error_code ignored;
    if (fs::is_regular_file(given, ignored) && ::access(given.c_str(), X_OK) == 0) return given;
    throw UnavailableError("--ffmpeg: " + given + " is no program that can be run");
  }
  const std::string name = given.empty() ? "ffmpeg" : given;
  std::string program = program_of_path(name);
  if (!program.empty()) return program;
  throw UnavailableError(fmt::format(
      "a film needs the program ffmpeg, and no absolute folder of PATH has '{}'; install the package ffmpeg, name the "
      "program with --ffmpeg FILE, or write frames into a folder (-o frames/)",
      name));
}

std::unique_ptr<FilmWriter> open_film(const FilmTarget& target) {
  if (target.kind == OutputKind::kFrames) return std::make_unique<FrameFolder>(target);
  if (target.kind == OutputKind::kMp4 && (target.width % 2 != 0 || target.height % 2 != 0)) {
    throw UsageError(fmt::format("--size {}x{}: an .mp4 needs even numbers, for example {}x{}", target.width,
                                 target.height, target.width + target.width % 2, target.height + target.height % 2));
  }
  constexpr double kMostGifFramesPerSecond = 50.0;  // a .gif counts hundredths, and players slow down what has but one
  if (target.kind == OutputKind::kGif && target.frames_per_s > kMostGifFramesPerSecond) {
    throw UsageError(fmt::format("--fps {}: a .gif shows at most {} frames a second; an .mp4 can show more",
                                 target.frames_per_s, kMostGifFramesPerSecond));
  }
  const std::string program = find_ffmpeg(target.ffmpeg);
  std::error_code ignored;
  if (const fs::file_status status = fs::status(target.path, ignored);
      fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) {
    throw FileError(target.path, "is no regular file, which a film needs");
  }
  return std::make_unique<FfmpegFilm>(target, program);
}

}  // namespace gdtslam
