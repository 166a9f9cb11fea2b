// simulate with a nodding laser: what lies in the log and beside it, which options count, and the sample scenes.
#if __has_include("gdtslam/sim/scene.hpp")  // the simulator may be left out of a build

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/carmen.hpp"
#include "gdtslam/io/sha256.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "linkage_file.hpp"
#include "scene_file.hpp"
#include "simulate_run.hpp"

namespace gdtslam {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kScenes = GDTSLAM_SOURCE_DIR "/assets/scenes";

std::string content_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct HitRow {
  std::array<double, 6> values{};        // x y z elevation time range
  std::array<std::uint32_t, 3> names{};  // scan beam triangle
};

// A reader of its own for the one layout that is promised.
std::vector<HitRow> read_hits(const std::string& path) {
  const std::string bytes = content_of(path);
  const std::string header =
      "property double x\nproperty double y\nproperty double z\nproperty double elevation\nproperty double time\n"
      "property double range\nproperty uint scan\nproperty uint beam\nproperty uint triangle\nend_header\n";
  const std::size_t at = bytes.find(header);
  EXPECT_EQ(bytes.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
  EXPECT_NE(at, std::string::npos);
  const std::size_t begin = at + header.size();
  std::vector<HitRow> rows((bytes.size() - begin) / 60);
  EXPECT_EQ((bytes.size() - begin) % 60, 0U);
  EXPECT_THAT(bytes.substr(0, begin), HasSubstr("element vertex " + std::to_string(rows.size()) + "\n"));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::memcpy(rows[i].values.data(), bytes.data() + begin + 60 * i, 48);
    std::memcpy(rows[i].names.data(), bytes.data() + begin + 60 * i + 48, 12);
  }
  return rows;
}

class SimulateNoddingTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '_');
    folder_ = std::filesystem::path(testing::TempDir()) / ("simulate_nodding_" + name);
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("small.yaml", kSmallScene);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }

  [[nodiscard]] SimulateOptions options(const std::string& output, const std::string& scene = "small.yaml") const {
    SimulateOptions options;
    options.scene = path(scene);
    options.output = path(output);
    return options;
  }

  [[nodiscard]] std::vector<Encoder> messages(const std::string& log) const {
    std::vector<Encoder> list;
    const auto reader = open_carmen(path(log), {});
    while (const auto record = reader->next()) {
      if (const auto* message = std::get_if<Encoder>(&*record)) list.push_back(*message);
    }
    EXPECT_TRUE(reader->warnings().empty());
    return list;
  }

  [[nodiscard]] std::vector<LaserScan> scans(const std::string& log) const {
    std::vector<LaserScan> list;
    const auto reader = open_carmen(path(log), {});
    while (const auto record = reader->next()) {
      if (const auto* scan = std::get_if<ScanRecord>(&*record)) list.push_back(scan->scan);
    }
    return list;
  }

  static constexpr const char* kSmallScene = R"(gdtslam_scene: 1
walls:
  - {points: [[0, 0], [6, 0], [6, 4], [0, 4]], closed: true}
floor: 0
ceiling: 2.5
robot:
  laser: {preset: hokuyo-961, beams: 97, bearing_step: 2.5 deg, mount: {x: 10 cm}, drop_outs: 1 %}
  nodding: {crank_rate: 0.5, encoder: {rate: 50}}
recording: {scan_rate: 5, odometry_rate: 10}
waypoints: [[1, 1], [4.5, 1], [4.5, 2]]
)";
  std::filesystem::path folder_;
};

TEST_F(SimulateNoddingTest, WritesEncoderLinkageElevationsAndHits) {
  SimulateOptions chosen = options("a.log.gz");
  chosen.truth_hits = true;
  const SimulateResult result = simulate(chosen);
  EXPECT_EQ(result.linkage_file, path("a.linkage.yaml"));
  EXPECT_EQ(result.elevation_file, path("a.elevation.csv"));
  EXPECT_EQ(result.hits_file, path("a.truth.ply"));

  // The log: 0.5 turns a second of 20,000 ticks are 200 ticks a message of 50 Hz, and the count wraps.
  const std::vector<Encoder> told = messages("a.log.gz");
  EXPECT_EQ(told.size(), result.encoder_lines);
  ASSERT_GT(told.size(), 200U);
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(told[i].ticks, static_cast<std::int64_t>(200 * i % 20000));
    EXPECT_NEAR(told[i].stamp_s, 0.02 * static_cast<double>(i), 1e-9);
  }

  // The linkage: the preset, with the laser's height and mirror.
  const calib::SweepModel model = read_linkage(result.linkage_file);
  EXPECT_EQ(model.bars.crank_m, 0.036);
  EXPECT_EQ(model.mount.height_m, 0.3);
  EXPECT_EQ(model.mirror_rate_hz, 40.0);
  EXPECT_EQ(model.stamp_share, 0.5);

  // The elevations: one row a scan, of its stamp.
  const std::vector<LaserScan> measured = scans("a.log.gz");
  std::ifstream csv(result.elevation_file);
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "scan,stamp_s,crank_turns,elevation_rad");
  std::size_t rows = 0;
  for (; std::getline(csv, line); ++rows) {
    std::istringstream fields(line);
    double scan = 0;
    double stamp = 0;
    double turns = 0;
    double elevation = 0;
    char comma = ' ';
    fields >> scan >> comma >> stamp >> comma >> turns >> comma >> elevation;
    EXPECT_EQ(scan, static_cast<double>(rows));
    EXPECT_NEAR(stamp, measured.at(rows).stamp_s, 1e-9);
    EXPECT_NEAR(turns, 0.5 * stamp, 1e-9);
    const double crank = model.encoder.zero_rad + model.encoder.direction * 2.0 * kPi * turns;
    EXPECT_NEAR(elevation, *calib::elevation_rad(model, crank), 1e-9);
  }
  EXPECT_EQ(rows, result.scans);

  // The hits: a row for each return, in the log's order, within the room, and within noise of what was measured.
  const std::vector<HitRow> hits = read_hits(result.hits_file);
  ASSERT_EQ(hits.size(), result.returns);
  std::size_t next = 0;
  for (std::size_t scan = 0; scan < measured.size(); ++scan) {
    for (std::size_t beam = 0; beam < measured[scan].ranges_m.size(); ++beam) {
      const double range_m = static_cast<double>(measured[scan].ranges_m[beam]);
      if (range_m >= 20.0) {
        continue;
      }
      const HitRow& hit = hits.at(next++);
      ASSERT_EQ(hit.names[0], scan);
      ASSERT_EQ(hit.names[1], beam);
      EXPECT_NEAR(hit.values[5], range_m, 0.07);
      EXPECT_NEAR(hit.values[4], measured[scan].stamp_s, 0.01);
      EXPECT_TRUE(hit.values[0] > 0.04 && hit.values[0] < 5.96 && hit.values[1] > 0.04 && hit.values[1] < 3.96);
      EXPECT_TRUE(hit.values[2] > -1e-9 && hit.values[2] < 2.5 + 1e-9);
    }
  }
  EXPECT_EQ(next, hits.size());
}

TEST_F(SimulateNoddingTest, ALaserThatDoesNotNodWritesNothingOfIt) {
  std::string text = kSmallScene;
  text.erase(text.find("  nodding:"), text.find("recording") - text.find("  nodding:"));
  write("level.yaml", text);
  const SimulateResult result = simulate(options("a.log", "level.yaml"));
  EXPECT_EQ(result.encoder_lines, 0U);
  EXPECT_TRUE(result.linkage_file.empty());
  EXPECT_FALSE(std::filesystem::exists(path("a.linkage.yaml")));
  EXPECT_FALSE(std::filesystem::exists(path("a.elevation.csv")));
  EXPECT_THAT(content_of(path("a.log")), Not(HasSubstr("ENCODER")));
  EXPECT_EQ(scans("a.log").front().stamp_s, 0.0);
  // The same scene nods when an option says so.
  SimulateOptions chosen = options("b.log", "level.yaml");
  chosen.linkage = "paper-a";
  simulate(chosen);
  EXPECT_EQ(read_linkage(path("b.linkage.yaml")).bars.ground_m, 0.125);
  chosen = options("c.log", "level.yaml");
  chosen.nod_mode = "continuous";
  simulate(chosen);
  EXPECT_EQ(read_linkage(path("c.linkage.yaml")).name, "paper-b");
}

TEST_F(SimulateNoddingTest, OptionsWinOverTheScene) {
  SimulateOptions chosen = options("a.log");
  chosen.crank_rate_hz = 0.1;
  chosen.is_exact = true;
  simulate(chosen);
  EXPECT_EQ(read_linkage(path("a.linkage.yaml")).encoder.ticks_per_turn, std::int64_t{1} << 30);
  // 0.1 Hz of 2^30 ticks at 1 s.
  EXPECT_EQ(messages("a.log")[50].ticks, 107374182);
  // Ranges have nine decimals, and no two neighbours of a wall are equal.
  EXPECT_THAT(content_of(path("a.log")), testing::ContainsRegex(" 97 [0-9]\\.[0-9]{9} "));
  EXPECT_EQ(simulate(chosen).returns, simulate(chosen).beams);

  chosen.ticks_per_turn = 1000;
  chosen.range_resolution_m = 0.5;
  simulate(chosen);
  EXPECT_EQ(read_linkage(path("a.linkage.yaml")).encoder.ticks_per_turn, 1000);
  for (const LaserScan& scan : scans("a.log")) {
    for (const float range_m : scan.ranges_m) {
      EXPECT_EQ(std::fmod(range_m, 0.5F), 0.0F);
    }
  }
}

TEST_F(SimulateNoddingTest, ALinkageFileIsTakenAsItIs) {
  calib::SweepModel model = calib::sweep_model_of_preset("paper-c");
  model.bars.crank_m += 0.0005;
  model.mount.lever_up_m = 0.02;
  model.encoder.ticks_per_turn = 4096;
  write_linkage(path("mine.yaml"), model);
  SimulateOptions chosen = options("a.log");
  chosen.linkage = path("mine.yaml");
  simulate(chosen);
  const calib::SweepModel written = read_linkage(path("a.linkage.yaml"));
  EXPECT_EQ(written.bars.crank_m, model.bars.crank_m);
  EXPECT_EQ(written.mount.lever_up_m, 0.02);
  EXPECT_EQ(written.encoder.ticks_per_turn, 4096);
  // A scene names it relative to itself.
  std::string text = kSmallScene;
  text.replace(text.find("{crank_rate"), 1, "{linkage: mine.yaml, ");
  write("named.yaml", text);
  simulate(options("b.log", "named.yaml"));
  EXPECT_EQ(read_linkage(path("b.linkage.yaml")).bars.crank_m, model.bars.crank_m);
}

TEST_F(SimulateNoddingTest, StopAndScanStandsAlongThePath) {
  SimulateOptions chosen = options("a.log");
  chosen.nod_mode = "stop-and-scan";
  const SimulateResult result = simulate(chosen);
  // 3.5 m and 1 m in pieces of at most 1 m: six stops of a turn of 2 s each.
  std::size_t turns = 0;
  const std::vector<Encoder> told = messages("a.log");
  for (std::size_t i = 1; i < told.size(); ++i) turns += told[i].ticks < told[i - 1].ticks ? 1U : 0U;
  EXPECT_EQ(turns, 6U);
  EXPECT_GT(result.duration_s, 6 * 2.0 + 4.5 / 0.7);
}

TEST_F(SimulateNoddingTest, FaultsOfTheEncoderReachTheLog) {
  std::string text = kSmallScene;
  text.replace(text.find("encoder: {rate: 50}"), 19,
               "encoder: {rate: 50}, encoder_faults: [{kind: missing, from: 1 s, to: 2 s}, {kind: jump, from: 3 s, "
               "ticks: 77}]");
  write("faulty.yaml", text);
  simulate(options("a.log", "faulty.yaml"));
  for (const Encoder& message : messages("a.log")) {
    EXPECT_TRUE(message.stamp_s < 1.0 || message.stamp_s >= 2.0);
    EXPECT_EQ(message.ticks % 200, message.stamp_s < 3.0 ? 0 : 77);
  }
}

TEST_F(SimulateNoddingTest, SameBytesOnAnyInstructionSetOfEmbree) {
  SimulateOptions chosen = options("a.log");
  chosen.truth_hits = true;
  simulate(chosen);
  chosen.output = path("b.log");
  for (const char* isa : {"", "sse2", "avx2", "avx512"}) {
    chosen.embree_isa = isa;
    try {
      simulate(chosen);
    } catch (const UnavailableError&) {
      continue;  // not on this processor
    }
    for (const char* ending : {".log", ".truth.tum", ".linkage.yaml", ".elevation.csv", ".truth.ply"}) {
      EXPECT_TRUE(content_of(path(std::string("a") + ending)) == content_of(path(std::string("b") + ending)))
          << isa << ending;
    }
  }
}

TEST_F(SimulateNoddingTest, RefusesWhatMakesNoSense) {
  SimulateOptions chosen = options("a.log");
  chosen.nod_mode = "stop-and-go";
  EXPECT_THROW(simulate(chosen), UsageError);
  chosen = options("a.log");
  chosen.crank_rate_hz = 0.0;
  EXPECT_THROW(simulate(chosen), UsageError);
  chosen = options("a.log");
  chosen.noise_m = -1.0;
  EXPECT_THROW(simulate(chosen), UsageError);
  chosen = options("a.log");
  chosen.linkage = "paper-d";
  EXPECT_THROW(simulate(chosen), Error);
  EXPECT_FALSE(std::filesystem::exists(path("a.log")));
  EXPECT_FALSE(std::filesystem::exists(path("a.linkage.yaml")));
}

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
    testing::Values(
        BadSection{"{crank_rates: 0.5}", "did you mean 'crank_rate'"},
        BadSection{"{crank_rate: 0}", "crank_rate must be 0.0001 to 50 Hz"}, BadSection{"{crank_rate: fast}", "fast"},
        BadSection{"{linkage: paper-d}", "paper-d"},
        BadSection{"{mode: stoped}", "unknown mode 'stoped'; did you mean 'stepped'?"},
        BadSection{"{mode: stepped, step: 1.8}", "unit"}, BadSection{"{mode: stepped, step: 400 deg}", "step must be"},
        BadSection{"{turns: 1.5}", "no whole number"}, BadSection{"{stop_every: 0}", "stop_every must be"},
        BadSection{"{encoder: {ticks_per_turn: 2.5}}", "no whole number"}, BadSection{"{encoder: {tick: 5}}", "tick"},
        BadSection{"{encoder: {rate: 0}}", "rate must be 1 to 10000 Hz"},
        BadSection{"{lever: {forwards: 1 cm}}", "did you mean 'forward'"},
        BadSection{"{lever: {forward: 2 m}}", "lever_forward"},
        BadSection{"{encoder_faults: [{kind: stops, from: 1}]}", "unknown fault 'stops'; did you mean 'stop'?"},
        BadSection{"{encoder_faults: [{kind: stop}]}", "from"},
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
        Sample{"office-3f", 1.0, 215, 56.9, "e5449c10c5d009c4ef6d8590f3cb30eaea69d0bca992fc7054653ad52613cf5e"},
        Sample{"office-7f", 1.0, 258, 62.6, "c488817c942b5e24fecad1a81cb7b825d037a7a9505dac161fed04590ed7f52a"},
        Sample{"three-boxes", 4.0, 161, 0.0, "f74c9541e66ee8f67d692534b901b7f1964adb9ba90919db372688577f56055b"},
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
