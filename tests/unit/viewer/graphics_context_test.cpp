// Ways to OpenGL: again and again, several at once, and in processes whose surroundings lack something.
#include <dirent.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "gdtslam/core/error.hpp"
#include "graphics_scene.hpp"

namespace gdtslam::test {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

RgbaImage picture_of_a_square(const GraphicsContext& graphics) {
  OffscreenView view(graphics);
  view.set_samples(2);
  view.set_eye_dome(true);
  add_shape(view, upright_square({0.0, 10.0, 0.0}, 1.0), kRed);
  add_shape(view, {{-2.0, 9.0, -1.5}, {2.5, 12.0, -1.0}, {1.0, 14.0, 2.0}}, kGreen);
  return view.render(camera_along_y(false), {160, 120});
}

std::size_t open_files() {
  std::size_t count = 0;
  DIR* folder = opendir("/proc/self/fd");
  while (folder != nullptr && readdir(folder) != nullptr) ++count;
  if (folder != nullptr) closedir(folder);
  return count;
}

std::size_t resident_pages() {
  std::size_t total = 0;
  std::size_t resident = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  const int read = file == nullptr ? 0 : std::fscanf(file, "%zu %zu", &total, &resident);
  if (file != nullptr) std::fclose(file);
  return read == 2 ? resident : 0;
}

std::string this_program() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

/// What another process of this program prints, which runs GraphicsProcess.Draws only. `before` is set before it in
/// the shell: assignments for env, or a program that starts it.
std::string other_process(const std::string& before) {
  const std::string command =
      before + " '" + this_program() +
      "' --gtest_filter=GraphicsProcess.Draws 2>&1 | sed -n 's/^graphics: //p; /^ *Actual:/d; /arning/p; "
      "/rror/p; /abort/Ip'";
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  if (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string drawing_or_error() {
  try {
    const GraphicsContext graphics;
    const RgbaImage image = picture_of_a_square(graphics);
    return "drew " + std::to_string(static_cast<int>(spot_of(image, kRed).count)) + " by " + graphics.description();
  } catch (const Error& error) {
    return "refused " + std::to_string(static_cast<int>(error.code())) + " " + error.what();
  }
}

// Run by itself it draws like everywhere; run by the tests below it says how it fared.
TEST(GraphicsProcess, Draws) {
  const std::string outcome = drawing_or_error();
  std::cout << "graphics: " << outcome << std::endl;
  EXPECT_THAT(outcome, StartsWith("drew "));
}

/// Runs `draw` until everything is warm and then 90 times; the files and memory that stay must be those from before.
template <typename Draw>
void expect_nothing_stays(const Draw& draw) {
  for (int i = 0; i < 10; ++i) draw();
  const std::size_t files = open_files();
  const std::size_t pages = resident_pages();
  for (int i = 0; i < 90; ++i) draw();
  EXPECT_LE(open_files(), files);
#if !defined(GDTSLAM_SANITIZE_ADDRESS) && !defined(GDTSLAM_SANITIZE_THREAD)  // which keep what was freed, or its shadow
  EXPECT_LT(static_cast<double>(resident_pages()), static_cast<double>(pages) + 90 * 0.25 * 256.0)
      << "a quarter of a MiB each at most";
#else
  EXPECT_GT(pages, 0U);
#endif
}

TEST(GraphicsContext, HundredInARowLeaveNothingBehind) {
  const RgbaImage first = picture_of_a_square(GraphicsContext());
  expect_nothing_stays([&first] { ASSERT_EQ(picture_of_a_square(GraphicsContext()).pixels, first.pixels); });
}

TEST(GraphicsContext, SeveralAtOnce) {
  auto one = std::make_unique<GraphicsContext>();
  const GraphicsContext other;
  OffscreenView red(*one);
  OffscreenView green(other);
  OffscreenView both(*one);
  add_shape(red, upright_square({0.0, 10.0, 0.0}, 1.0), kRed);
  add_shape(green, upright_square({0.0, 10.0, 0.0}, 1.0), kGreen);
  add_shape(both, upright_square({-1.0, 10.0, 0.0}, 0.5), kRed);
  add_shape(both, upright_square({1.0, 10.0, 0.0}, 0.5), kGreen);
  one.reset();  // what draws keeps what it needs
  const Camera camera = camera_along_y(true);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(spot_of(red.render(camera, {120, 120}), kRed).count, 1600.0);
    EXPECT_EQ(spot_of(green.render(camera, {90, 60}), kGreen).count, 400.0);
    const RgbaImage image = both.render(camera, {120, 120});
    EXPECT_EQ(spot_of(image, kRed).count, 400.0);
    EXPECT_EQ(spot_of(image, kGreen).count, 400.0);
  }
}

TEST(GraphicsContext, OnePerThread) {
  const RgbaImage expected = picture_of_a_square(GraphicsContext());
  std::vector<RgbaImage> images(4);
  std::vector<std::thread> threads;
  for (RgbaImage& image : images) threads.emplace_back([&image] { image = picture_of_a_square(GraphicsContext()); });
  for (std::thread& thread : threads) thread.join();
  for (const RgbaImage& image : images) EXPECT_EQ(image.pixels, expected.pixels);
}

TEST(GraphicsContext, DrawsWithoutADisplayOrAHome) {
  const std::string usual = other_process("env -u DISPLAY -u WAYLAND_DISPLAY");
  EXPECT_THAT(usual, StartsWith("drew "));
  EXPECT_THAT(usual, HasSubstr("EGL"));
  EXPECT_THAT(usual, HasSubstr("OpenGL"));
  EXPECT_EQ(other_process("env -u HOME -u XDG_CACHE_HOME -u XDG_RUNTIME_DIR"), usual);
  EXPECT_EQ(other_process("env HOME=/dev/null/none XDG_RUNTIME_DIR=/dev/null/none"), usual);
  EXPECT_EQ(other_process("env DISPLAY=:7777 WAYLAND_DISPLAY=nothing"), usual);
  EXPECT_EQ(other_process("env DISPLAY=nowhere.invalid:0"), usual);
}

TEST(GraphicsContext, SaysInOneLineWhyNothingCanDraw) {
  const std::string no_driver = "env -u DISPLAY __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null/none";
  const std::string text = other_process(no_driver);
  EXPECT_THAT(text, StartsWith("refused 69 nothing here can draw with OpenGL: EGL"));
  EXPECT_THAT(text, EndsWith("(apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri)"));
  EXPECT_THAT(text, Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace gdtslam::test
