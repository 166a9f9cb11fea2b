// Films: what reaches ffmpeg, seen by a program of our own in its place, and what is left when something fails.
#include "tools/gdtslam/render/files/film_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

class FilmWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    std::signal(SIGPIPE, SIG_IGN);  // as the command has it
    fs::create_directories(folder_ / "bin");
    path_ = std::getenv("PATH");
    ::setenv("PATH", ((folder_ / "bin").string() + ":" + path_).c_str(), 1);
  }
  void TearDown() override {
    ::setenv("PATH", path_.c_str(), 1);
    fs::remove_all(folder_);
  }

  /// Puts a program in ffmpeg's place; $out is the film's file.
  void replace_ffmpeg(const std::string& script) const {
    const fs::path path = folder_ / "bin/ffmpeg";
    std::ofstream(path) << "#!/bin/sh\nfor last; do :; done\nout=${last#file:}\n" << script;
    fs::permissions(path, fs::perms::owner_all);
  }
  [[nodiscard]] std::string film(const char* name = "film.mp4") const { return (folder_ / name).string(); }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())) - 1;
  }

  fs::path folder_ = fs::temp_directory_path() / ("gdtslam-film-" + std::to_string(::getpid()));
  std::string path_;
};

std::string film_content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Each pixel its own colour, another one in each frame.
RgbaImage frame_of(std::uint32_t width, std::uint32_t height, std::uint8_t shade) {
  RgbaImage image(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      std::uint8_t* const pixel = image.at(x, y);
      pixel[0] = static_cast<std::uint8_t>(x);
      pixel[1] = static_cast<std::uint8_t>(y);
      pixel[2] = shade;
      pixel[3] = 255;
    }
  }
  return image;
}

ExitCode code_of(const std::function<void()>& act, std::string* what = nullptr) {
  try {
    act();
  } catch (const Error& error) {
    if (what != nullptr) *what = error.what();
    return error.code();
  }
  return ExitCode::kDone;
}

void write_film(const FilmTarget& target, std::size_t frames) {
  const std::unique_ptr<FilmWriter> writer = open_film(target);
  for (std::size_t k = 0; k < frames; ++k) {
    writer->add(frame_of(target.width, target.height, static_cast<std::uint8_t>(40 * k)));
  }
  writer->finish();
}

TEST_F(FilmWriterTest, FramesReachTheProgramAsRowsOfRedGreenBlue) {
  replace_ffmpeg("cat > \"$out\"\n");
  write_film({FilmKind::kMp4, film(), 4, 2}, 3);
  std::string expected;
  for (int frame = 0; frame < 3; ++frame) {
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 4; ++x)
        expected += {static_cast<char>(x), static_cast<char>(y), static_cast<char>(40 * frame)};
    }
  }
  EXPECT_EQ(film_content(film()), expected);
  EXPECT_EQ(files(), 1U);
}

TEST_F(FilmWriterTest, AFailureIsReportedAndLeavesTheOldFilm) {
  std::ofstream(film()) << "old";
  struct Failure {
    const char* script;
    ExitCode code;
    const char* words;
  };
  for (const Failure& failure :
       {Failure{"cat > /dev/null; echo 'something is' >&2; echo 'odd' >&2; exit 3\n", ExitCode::kFailed,
                "ffmpeg failed (exit 3): something is;odd"},
        Failure{"echo 'no more' >&2; exit 4\n", ExitCode::kFailed, "ffmpeg failed (exit 4): no more"},
        Failure{"kill -9 $$\n", ExitCode::kFailed, "signal 9"},
        Failure{"cat > /dev/null\n", ExitCode::kFailed, "no film"},
        Failure{"cat > /dev/null; echo 'No space left on device' >&2; exit 1\n", ExitCode::kInputOutput, "film.mp4"}}) {
    replace_ffmpeg(failure.script);
    std::string what;
    EXPECT_EQ(code_of([&] { write_film({FilmKind::kMp4, film(), 640, 480}, 20); }, &what), failure.code);
    EXPECT_NE(what.find(failure.words), std::string::npos) << what;
    EXPECT_EQ(film_content(film()), "old");
    EXPECT_EQ(files(), 1U) << failure.script;
  }
}

TEST_F(FilmWriterTest, AWriterThatIsLeftEndsItsProgramAndLeavesNothing) {
  replace_ffmpeg("echo $$ > '" + film("pid") + "'; exec sleep 1000\n");
  {
    const auto writer = open_film({FilmKind::kMp4, film(), 4, 2});
    while (film_content(film("pid")).empty()) ::usleep(1000);
  }
  EXPECT_NE(::kill(std::stoi(film_content(film("pid"))), 0), 0) << "the program still runs";
  EXPECT_EQ(files(), 1U);
}

TEST_F(FilmWriterTest, MistakesAreRefusedBeforeAFrameIsDrawn) {
  replace_ffmpeg("cat > \"$out\"\n");
  std::string what;
  EXPECT_EQ(code_of([&] { open_film({FilmKind::kMp4, film(), 5, 3}); }, &what), ExitCode::kUsage);
  EXPECT_NE(what.find("6x4"), std::string::npos) << what;
  EXPECT_EQ(code_of([&] { open_film({FilmKind::kGif, film("film.gif"), 4, 2, 60.0}); }), ExitCode::kUsage);
  EXPECT_EQ(code_of([&] { open_film({FilmKind::kMp4, film("no/film.mp4"), 4, 2}); }), ExitCode::kInputOutput);
  EXPECT_EQ(code_of([&] { open_film({FilmKind::kMp4, "/dev/null", 4, 2}); }), ExitCode::kInputOutput);
}

// Logs are often unpacked in the folder where the command is run: no program is taken from there.
TEST_F(FilmWriterTest, TheProgramIsOneOfAnAbsoluteFolderOfPath) {
  replace_ffmpeg("cat > \"$out\"\n");
  const fs::path here = fs::current_path();
  fs::current_path(folder_ / "bin");
  for (const char* untrusted : {"", ".", "/nonexistent:", "./"}) {
    ::setenv("PATH", untrusted, 1);
    std::string what;
    EXPECT_EQ(code_of([&] { open_film({FilmKind::kMp4, film(), 4, 2}); }, &what), ExitCode::kUnavailable) << untrusted;
    EXPECT_NE(what.find("install the package ffmpeg"), std::string::npos) << what;
  }
  fs::current_path(here);
}

TEST_F(FilmWriterTest, FramesOfAShorterFilmReplaceThoseOfALongerOne) {
  write_film({FilmKind::kFrames, film("frames/"), 4, 2}, 3);
  std::ofstream(film("frames/frame-0009.png")) << "behind a gap";
  write_film({FilmKind::kFrames, film("frames/"), 4, 2}, 2);
  EXPECT_EQ(film_content(film("frames/frame-0002.png")).substr(1, 3), "PNG");
  EXPECT_FALSE(fs::exists(film("frames/frame-0003.png")));
  EXPECT_TRUE(fs::exists(film("frames/frame-0009.png")));
}

}  // namespace
}  // namespace gdtslam
