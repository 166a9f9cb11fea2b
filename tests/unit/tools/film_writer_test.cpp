// Films: what reaches ffmpeg, seen by a program of our own in its place, what ffprobe says of real ones, and what is
// left when something fails.
#include "tools/gdtslam/render/film_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"
#include "support/required_program.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;

class FilmWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("gdtslam-film-" + std::to_string(::getpid()) + "-" +
                                           testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // A program in ffmpeg's place; $out is the film's descriptor.
  std::string program(const std::string& script) {
    const fs::path path = folder_ / "ffmpeg";
    std::ofstream(path) << "#!/bin/sh\nfor last; do :; done\nout=$last\n" << script;
    fs::permissions(path, fs::perms::owner_all);
    return path.string();
  }
  [[nodiscard]] std::string film(const char* name = "film.mp4") const { return (folder_ / name).string(); }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const auto& entry : fs::directory_iterator(folder_)) list.push_back(entry.path().filename().string());
    std::sort(list.begin(), list.end());
    return list;
  }

  fs::path folder_;
};

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Each pixel its own colour, another one in each frame; alpha as a film should ignore it.
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
  const std::string ffmpeg = program("cat > \"$out\"\n");
  write_film({OutputKind::kMp4, film(), 4, 2, 25.0, ffmpeg}, 3);
  std::string expected;
  for (int frame = 0; frame < 3; ++frame) {
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 4; ++x)
        expected += {static_cast<char>(x), static_cast<char>(y), static_cast<char>(40 * frame)};
    }
  }
  EXPECT_EQ(content(film()), expected);
  EXPECT_EQ(names(), (std::vector<std::string>{"ffmpeg", "film.mp4"}));
}

TEST_F(FilmWriterTest, TheProgramIsToldSizeRateAndKind) {
  const std::string ffmpeg = program("cat > /dev/null; echo \"$@\" > \"$out\"\n");
  write_film({OutputKind::kGif, film("f.gif"), 6, 3, 12.5, ffmpeg}, 1);
  const std::string words = content(film("f.gif"));
  for (const char* part : {"-f rawvideo", "-pixel_format rgb24", "-video_size 6x3", "-framerate 12.5", "palettegen",
                           "paletteuse", "-f gif"}) {
    EXPECT_NE(words.find(part), std::string::npos) << part << " is not in " << words;
  }
}

TEST_F(FilmWriterTest, WhatTheProgramComplainsOfIsTold) {
  const std::string ffmpeg = program("cat > /dev/null; echo 'pipe:0: something is' >&2; echo 'odd' >&2; exit 3\n");
  std::string what;
  EXPECT_EQ(code_of([&] { write_film({OutputKind::kMp4, film(), 4, 2, 25.0, ffmpeg}, 2); }, &what), ExitCode::kFailed);
  EXPECT_EQ(what, "ffmpeg failed (exit 3): pipe:0: something is; odd");
  EXPECT_EQ(names(), std::vector<std::string>{"ffmpeg"});
}

TEST_F(FilmWriterTest, AProgramThatStopsReadingIsAFailureAndNoSignal) {
  const std::string ffmpeg = program("echo 'no more' >&2; exit 4\n");
  std::signal(SIGPIPE, SIG_IGN);  // as the command has it
  std::string what;
  EXPECT_EQ(code_of(
                [&] {
                  write_film({OutputKind::kMp4, film(), 640, 480, 25.0, ffmpeg}, 40);
                },
                &what),
            ExitCode::kFailed);
  EXPECT_EQ(what, "ffmpeg failed (exit 4): no more");
}

TEST_F(FilmWriterTest, AFullDiskIsAFailureToWrite) {
  const std::string ffmpeg = program("cat > /dev/null; echo 'av_write_frame: No space left on device' >&2; exit 1\n");
  EXPECT_EQ(code_of([&] { write_film({OutputKind::kMp4, film(), 4, 2, 25.0, ffmpeg}, 1); }), ExitCode::kInputOutput);
}

TEST_F(FilmWriterTest, AProgramThatIsKilledOrWritesNothingIsAFailure) {
  std::string what;
  const std::string killed = program("kill -9 $$\n");
  EXPECT_EQ(code_of([&] { write_film({OutputKind::kMp4, film(), 4, 2, 25.0, killed}, 1); }, &what), ExitCode::kFailed);
  EXPECT_NE(what.find("signal 9"), std::string::npos) << what;
  const std::string idle = program("cat > /dev/null\n");
  EXPECT_EQ(code_of([&] { write_film({OutputKind::kMp4, film(), 4, 2, 25.0, idle}, 1); }, &what), ExitCode::kFailed);
  EXPECT_NE(what.find("no film"), std::string::npos) << what;
}

TEST_F(FilmWriterTest, AnOldFilmStaysUntilTheNewOneIsWhole) {
  std::ofstream(film()) << "old";
  EXPECT_EQ(code_of([&] {
              write_film({OutputKind::kMp4, film(), 4, 2, 25.0, program("exit 1\n")}, 1);
            }),
            ExitCode::kFailed);
  EXPECT_EQ(content(film()), "old");
  write_film({OutputKind::kMp4, film(), 4, 2, 25.0, program("cat > \"$out\"\n")}, 1);
  EXPECT_EQ(content(film()).size(), 24U);
}

TEST_F(FilmWriterTest, AWriterThatIsLeftEndsItsProgramAndLeavesNothing) {
  const std::string ffmpeg = program("echo $$ > '" + film("pid") + "'; exec sleep 1000\n");
  {
    const auto writer = open_film({OutputKind::kMp4, film(), 4, 2, 25.0, ffmpeg});
    while (content(film("pid")).empty()) ::usleep(1000);
  }
  const int pid = std::stoi(content(film("pid")));
  EXPECT_NE(::kill(pid, 0), 0) << "the program still runs";
  EXPECT_FALSE(fs::exists(film()));
}

TEST_F(FilmWriterTest, WhatCannotWorkIsRefusedBeforeAFrameIsDrawn) {
  const std::string ffmpeg = program("cat > \"$out\"\n");
  std::string what;
  EXPECT_EQ(code_of([&] { open_film({OutputKind::kMp4, film(), 5, 3, 25.0, ffmpeg}); }, &what), ExitCode::kUsage);
  EXPECT_NE(what.find("6x4"), std::string::npos) << what;
  EXPECT_EQ(code_of([&] {
              open_film({OutputKind::kMp4, film("no/film.mp4"), 4, 2, 25.0, ffmpeg});
            }),
            ExitCode::kInputOutput);
  // Of a .gif a frame stays for whole hundredths of a second, at least two.
  EXPECT_EQ(code_of(
                [&] {
                  open_film({OutputKind::kGif, film("film.gif"), 4, 2, 60.0, ffmpeg});
                },
                &what),
            ExitCode::kUsage);
  EXPECT_NE(what.find("--fps 60"), std::string::npos) << what;
  EXPECT_NO_THROW(open_film({OutputKind::kGif, film("film.gif"), 4, 2, 50.0, ffmpeg}));
  EXPECT_EQ(code_of([&] { open_film({OutputKind::kMp4, "/dev/null", 4, 2, 25.0, ffmpeg}); }), ExitCode::kInputOutput);
  EXPECT_EQ(code_of([&] { open_film({OutputKind::kMp4, film(), 4, 2, 25.0, film("none")}); }), ExitCode::kUnavailable);
  EXPECT_EQ(code_of([&] {
              const auto writer = open_film({OutputKind::kMp4, film(), 4, 2, 25.0, ffmpeg});
              writer->add(frame_of(2, 4, 0));
            }),
            ExitCode::kFailed);
}

TEST_F(FilmWriterTest, ProgramOfPath) {
  const std::string ffmpeg = program("exit 0\n");
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", ("/nonexistent:" + folder_.string()).c_str(), 1);
  EXPECT_EQ(find_ffmpeg(""), ffmpeg);
  ::setenv("PATH", "/nonexistent", 1);
  std::string what;
  EXPECT_EQ(code_of([] { find_ffmpeg(""); }, &what), ExitCode::kUnavailable);
  EXPECT_NE(what.find("install the package ffmpeg"), std::string::npos) << what;
  ::setenv("PATH", path.c_str(), 1);
}

// Logs are often unpacked where the command is run: no program is taken from there unless it is named.
TEST_F(FilmWriterTest, ProgramOfTheWorkingFolderIsNotTaken) {
  program("exit 0\n");
  const std::string path = std::getenv("PATH");
  const fs::path here = fs::current_path();
  fs::current_path(folder_);
  for (const char* untrusted :
       {"", ".", ":/nonexistent", "/nonexistent:", "/nonexistent::/nonexistent", "./", "../."}) {
    ::setenv("PATH", untrusted, 1);
    EXPECT_EQ(code_of([] { find_ffmpeg(""); }), ExitCode::kUnavailable) << "PATH=" << untrusted;
  }
  EXPECT_EQ(find_ffmpeg("./ffmpeg"), "./ffmpeg");
  fs::current_path(here);
  ::setenv("PATH", path.c_str(), 1);
}

TEST_F(FilmWriterTest, FramesOfAFolderAndOfAPattern) {
  EXPECT_EQ(frame_path("out/", 0), "out/frame-0001.png");
  EXPECT_EQ(frame_path("out", 11), "out/frame-0012.png");
  EXPECT_EQ(frame_path("a/f%03d.png", 6), "a/f007.png");
  EXPECT_EQ(frame_path("f%d.png", 12344), "f12345.png");
  EXPECT_TRUE(is_frame_pattern("a/f%04d.png"));
  EXPECT_FALSE(is_frame_pattern("100%.png"));
  for (const char* wrong : {"f%04d.jpg", "f%02d-%02d.png", "f%99d.png"}) {
    EXPECT_EQ(code_of([wrong] { frame_path(wrong, 0); }), ExitCode::kUsage) << wrong;
  }
  write_film({OutputKind::kFrames, film("frames/"), 4, 2, 25.0, ""}, 3);
  for (const char* name : {"frames/frame-0001.png", "frames/frame-0002.png", "frames/frame-0003.png"}) {
    EXPECT_EQ(content(film(name)).substr(1, 3), "PNG");
  }
}

std::string output_of(const std::string& command) {
  std::string text;
  FILE* const pipe = ::popen(command.c_str(), "r");
  for (char letter = 0; ::fread(&letter, 1, 1, pipe) == 1;) text += letter;
  ::pclose(pipe);
  return text;
}

TEST_F(FilmWriterTest, ColoursComeBack) {
  GDTSLAM_NEEDS_PROGRAMS("ffmpeg ffprobe");
  RgbaImage frame(32, 32);
  for (std::size_t k = 0; k < frame.pixels.size(); k += 4) {
    frame.pixels[k] = 200;
    frame.pixels[k + 1] = 71;
    frame.pixels[k + 2] = 29;
    frame.pixels[k + 3] = 255;
  }
  for (const auto& [kind, name] : {std::pair{OutputKind::kMp4, "c.mp4"}, std::pair{OutputKind::kGif, "c.gif"}}) {
    const auto writer = open_film({kind, film(name), 32, 32, 25.0, ""});
    for (int k = 0; k < 3; ++k) writer->add(frame);
    writer->finish();
    const std::string rgb = output_of("ffmpeg -v error -i " + film(name) + " -frames:v 1 -f rawvideo -pix_fmt rgb24 -");
    ASSERT_EQ(rgb.size(), 3072U) << name;
    const int expected[] = {200, 71, 29};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(static_cast<unsigned char>(rgb[1500 + k]), expected[k], 4) << name << ", channel " << k;
    }
  }
}

}  // namespace
}  // namespace gdtslam
