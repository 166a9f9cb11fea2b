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
