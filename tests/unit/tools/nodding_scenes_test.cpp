// Scenes with a nodding laser: one clear line for a section that cannot be, and the bytes of the sample scenes.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "simulate_nodding_fixture.hpp"
#include "tools/gdtslam/scenes/scene_file.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;

const std::string kScenes = GDTSLAM_SOURCE_DIR "/assets/scenes";

struct BadSection {
  const char* nodding;
  const char* message;
};

class BadNoddingTest : public SimulateNoddingTest, public testing::WithParamInterface<BadSection> {};

TEST_P(BadNoddingTest, IsNamedWithFileAndLine) {
  std::string text = kSmallScene;
  const std::size_t begin = text.find("{crank_rate");
  text.replace(begin, text.find('\n', begin) - begin, GetParam().nodding);
  write("bad.yaml", text);
  try {
    read_scene(path("bad.yaml"));
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find(path("bad.yaml") + ":8"), 0U) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_THAT(message, HasSubstr(GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Sections, BadNoddingTest,
    testing::Values(BadSection{"{crank_rates: 0.5}", "did you mean 'crank_rate'"},
                    BadSection{"{crank_rate: 0}", "crank_rate must be 0.0001 to 50 Hz"},
                    BadSection{"{linkage: paper-d}", "paper-d"},
                    BadSection{"{mode: stoped}", "unknown mode 'stoped'; did you mean 'stepped'?"},
                    BadSection{"{turns: 1.5}", "no whole number"}, BadSection{"{encoder: {tick: 5}}", "tick"},
                    BadSection{"{lever: {forward: 2 m}}", "lever_forward"},
                    BadSection{"{encoder_faults: [{kind: stops, from: 1}]}", "unknown fault 'stops'"},
                    BadSection{"{encoder_faults: [{kind: stop, from: 3, to: 2}]}",
                               "must begin at a finite time and not end before"},
                    BadSection{"{encoder_faults: [{kind: jump, from: 3}]}", "ticks"}, BadSection{"continuous", ""}));

// The sample scenes, at a low rate of scans so that the test stays short.
struct Sample {
  const char* name;
  double rate_hz;
  std::size_t scans;
  double path_m;
  const char* log_sha256;
};

class NoddingSceneTest : public SimulateNoddingTest, public testing::WithParamInterface<Sample> {};

TEST_P(NoddingSceneTest, GivesTheExpectedBytes) {
  SimulateOptions chosen = options("s.log");
  chosen.scene = GetParam().name;
  chosen.scene_folders = {kScenes};
  chosen.scan_rate_hz = GetParam().rate_hz;
  const SimulateResult result = simulate(chosen);
  EXPECT_EQ(result.scans, GetParam().scans);
  EXPECT_NEAR(result.path_m, GetParam().path_m, 0.1);
  Sha256 digest;
  digest.update(content_of(path("s.log")));
  EXPECT_EQ(digest.hex(), GetParam().log_sha256);
}

INSTANTIATE_TEST_SUITE_P(
    Samples, NoddingSceneTest,
    testing::Values(
        Sample{"office-3f", 1.0, 215, 56.9, "39479aa9c60669eed6007a2fa31a27427a1134ee137e62b5f8ee7a4a16cc9133"},
        Sample{"office-7f", 1.0, 258, 62.6, "3d7fa3c6414bdc12f6a3b480e37e8b09a2cae14efd32a03a26d76e1822cba763"},
        Sample{"two-levels", 1.0, 251, 60.0, "4d5816a58cd61795ab8bbf66454cfeab41f634e13591f0eadfd2b2ddfffd3274"},
        Sample{"three-boxes", 4.0, 160, 0.0, "a269bf788fd1d3084e7dccd8ea8e28705a534ccef05f8c8878ccce695a736f58"},
        Sample{"wall", 4.0, 10041, 0.0, "2f9effa34ab185075663a35e525bf200d132ae889e2a5cfe03706c7c45c5569a"},
        Sample{"walls", 4.0, 181, 0.0, "de8ba4b763e6de7d044c8c4b20b6d922e9fa0f9b6a424cc0b473358fa9869cf6"}),
    [](const auto& sample) {
      std::string name = sample.param.name;
      std::erase(name, '-');
      return name;
    });

}  // namespace
}  // namespace gdtslam

#endif
