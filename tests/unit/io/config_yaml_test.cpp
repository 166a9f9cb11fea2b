// Configurations: values with units, every fault named at once, nothing changed by a faulty file.
#include "gdtslam/io/config_yaml.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "engine/io/did_you_mean.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/config.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

enum class Colour : std::uint8_t { kRed, kGreen };
constexpr std::array<std::string_view, 2> kColourNames = {"red", "green"};

struct Sample {
  double length_m = 0.05;
  double angle_rad = 0.5;
  std::int32_t count = 3;
  bool is_on = false;
  Colour colour = Colour::kRed;
  double top = 1.0;
  std::vector<Option> options() {
    return {{"top", "at the top", Unit::kNone, 0.0, 2.0, &top},
            {"map.length", "a length", Unit::kMetre, 0.01, 1.0, &length_m},
            {"map.angle", "an angle", Unit::kRadian, -4.0, 4.0, &angle_rad},
            {"gate.count", "a count", Unit::kNone, 1.0, 10.0, &count},
            {"gate.on", "a switch", Unit::kNone, 0.0, 0.0, &is_on},
            {"map.colour", "a colour", Unit::kNone, 0.0, 0.0, Choice(colour, kColourNames)}};
  }
};

std::string config_error(std::string_view text) {
  Sample sample;
  const std::vector<Option> options = sample.options();
  try {
    read_config_text(text, "c.yaml", options);
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.code(), ExitCode::kBadConfig);
    EXPECT_EQ(sample.length_m, 0.05);  // nothing changed
    EXPECT_EQ(sample.count, 3);
    return error.what();
  }
  return "no error";
}

TEST(ConfigYaml, ReadsValuesWithUnits) {
  Sample sample;
  const std::vector<std::string> paths = read_config_text(
      "version: 1\n"
      "top: 1.5  # a comment\n"
      "map:\n  length: 7 cm\n  angle: 90 deg\n  colour: green\n"
      "gate: {count: 7, on: true}\n",
      "c.yaml", sample.options());
  EXPECT_EQ(sample.top, 1.5);
  EXPECT_EQ(sample.length_m, 0.07);
  EXPECT_NEAR(sample.angle_rad, kPi / 2.0, 1e-15);
  EXPECT_EQ(sample.colour, Colour::kGreen);
  EXPECT_EQ(sample.count, 7);
  EXPECT_TRUE(sample.is_on);
  EXPECT_THAT(paths, ElementsAre("top", "map.length", "map.angle", "map.colour", "gate.count", "gate.on"));
}

TEST(ConfigYaml, UnknownNamesGetTheirLineAndTheNearestName) {
  EXPECT_EQ(config_error("map:\n  lenght: 5 cm\n"),
            "c.yaml:2: unknown option \"map.lenght\"; did you mean map.length?");
  EXPECT_EQ(config_error("mpa:\n  length: 5 cm\n"), "c.yaml:1: unknown option \"mpa\"; did you mean the section map?");
  EXPECT_EQ(config_error("zzzzzz:\n  length: 5 cm\n"),
            "c.yaml:1: unknown option \"zzzzzz\"; `gdtslam config show --all` lists all");
  EXPECT_EQ(config_error("length: 5 cm\n"), "c.yaml:1: unknown option \"length\"; did you mean map.length?");
}

TEST(ConfigYaml, EveryFaultIsNamedWithPathValueAndBound) {
  const std::string error = config_error(
      "map:\n  length: 2 m\n  angle: 3 s\n  colour: gren\ngate:\n  count: 2.5\n  on: maybe\n  cuont: 1\ntop: -0.5\n");
  EXPECT_THAT(error, HasSubstr("c.yaml:2: map.length: \"2 m\" is above its maximum 1 m"));
  EXPECT_THAT(error, HasSubstr("c.yaml:3: map.angle: \"3 s\" is no value of it"));
  EXPECT_THAT(error, HasSubstr("c.yaml:4: map.colour: \"gren\" is none of red, green; did you mean green?"));
  EXPECT_THAT(error, HasSubstr("c.yaml:6: gate.count: \"2.5\" is no whole number"));
  EXPECT_THAT(error, HasSubstr("c.yaml:7: gate.on: \"maybe\" is neither true nor false"));
  EXPECT_THAT(error, HasSubstr("c.yaml:8: unknown option \"gate.cuont\"; did you mean gate.count?"));
  EXPECT_THAT(error, HasSubstr("c.yaml:9: top: \"-0.5\" is below its minimum 0"));
  EXPECT_THAT(error, Not(HasSubstr("\n")));
}

// 0.2 rad are 11.45915590... deg, and are told as 11.4592 deg.
TEST(ConfigYaml, ABoundIsTakenAsItIsTold) {
  double angle_rad = 0.1;
  const std::vector<Option> options{
      {.path = "angle", .doc = "d", .unit = Unit::kRadian, .min = 0.0, .max = 0.2, .value = &angle_rad}};
  read_config_text("angle: 11.4592 deg\n", "c", options);
  EXPECT_EQ(angle_rad, 0.2);
  try {
    read_config_text("angle: 11.4593 deg\n", "c", options);
    ADD_FAILURE() << "taken";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is above its maximum 11.4592 deg"));
  }
}

TEST(ConfigYaml, WrongStructureIsNamed) {
  EXPECT_THAT(config_error("version: 2\n"), HasSubstr("c.yaml:1: version: this program reads version 1"));
  EXPECT_THAT(config_error("map: 5\n"), HasSubstr("c.yaml:1: map is a section"));
  EXPECT_THAT(config_error("map:\n  length: [1, 2]\n"), HasSubstr("c.yaml:2: map.length: must be a single value"));
  EXPECT_THAT(config_error("map:\n  length:\n"), HasSubstr("c.yaml:2: map.length"));
  EXPECT_THAT(config_error("top: 1\ntop: 2\n"), HasSubstr("c.yaml:2: \"top\" is given twice"));
  EXPECT_THAT(config_error("- 1\n"), HasSubstr("a configuration is a map"));
  EXPECT_THAT(config_error("{[1]: 2}\n"), HasSubstr("a name must be a plain word"));
  EXPECT_THAT(config_error("top: 1\n---\ntop: 2\n"), HasSubstr("more than one YAML document"));
  EXPECT_THAT(config_error("top: *nowhere\n"), HasSubstr("is not valid YAML"));
}

TEST(ConfigYaml, HostileNestingAndAliasesAreBounded) {
  EXPECT_THAT(config_error(std::string(100000, '[')), HasSubstr("nested too deeply"));
  std::string dashes;
  for (int i = 0; i < 50000; ++i) {
    dashes += "- ";
  }
  EXPECT_THAT(config_error(dashes), HasSubstr("nested too deeply"));
  EXPECT_THAT(config_error("map: &a\n  length: *a\n"), HasSubstr("map.length: must be a single value"));
  std::string laughs = "a0: &a0 1\n";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "*a" + std::to_string(i - 1);
    laughs += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + before + ", " + before + "]\n";
  }
  EXPECT_THAT(config_error(laughs), HasSubstr("and 40 more"));
  EXPECT_THAT(config_error(std::string(3U << 20U, ' ')), HasSubstr("is longer than"));
}

TEST(ConfigYaml, SetOptionTakesAssignments) {
  Sample sample;
  const std::vector<Option> options = sample.options();
  EXPECT_EQ(set_option(options, "map.length=25cm"), "map.length");
  EXPECT_EQ(sample.length_m, 0.25);
  set_option(options, "gate.on=true");
  EXPECT_TRUE(sample.is_on);
  const auto error = [&](std::string_view assignment) {
    try {
      set_option(options, assignment);
    } catch (const ConfigError& fault) {
      return std::string(fault.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error("map.lenght=1"), HasSubstr("did you mean map.length?"));
  EXPECT_THAT(error("map.length"), HasSubstr("write path=value"));
  EXPECT_THAT(error("map.length="), HasSubstr("map.length: \"\""));
  EXPECT_THAT(error("map.length=9 m"), HasSubstr("above its maximum 1 m"));
  EXPECT_THAT(error("map.length=0.5"), HasSubstr("'0.5' needs a unit: 0.5 cm, 0.5 m"));
  read_config_text("map: {length: 0.5}", "file", options);  // in a file a bare number is in metres
  EXPECT_EQ(sample.length_m, 0.5);
}

TEST(ConfigYaml, WhatIsWrittenReadsBackAsTheSameBits) {
  const TemporaryFolder folder;
  Sample written{0.123456789012345678, -1.0 / 3.0, 9, true, Colour::kGreen, 1e-7};
  put_file(folder / "c.yaml", config_text(written.options()));
  Sample read;
  EXPECT_EQ(read_config(folder / "c.yaml", read.options()).size(), 6U);
  EXPECT_EQ(read.length_m, written.length_m);
  EXPECT_EQ(read.angle_rad, written.angle_rad);
  EXPECT_EQ(read.count, written.count);
  EXPECT_EQ(read.is_on, written.is_on);
  EXPECT_EQ(read.colour, written.colour);
  EXPECT_EQ(read.top, written.top);
}

TEST(ConfigYaml, SchemaDescribesEveryOption) {
  Sample sample;
  const nlohmann::json schema = nlohmann::json::parse(config_schema(sample.options()));
  EXPECT_EQ(schema.at("additionalProperties"), false);
  EXPECT_EQ(schema.at("properties").at("version").at("const"), 1);
  const nlohmann::json& map = schema.at("properties").at("map");
  EXPECT_EQ(map.at("additionalProperties"), false);
  const nlohmann::json& length = map.at("properties").at("length");
  EXPECT_EQ(length.at("description"), "a length");
  EXPECT_EQ(length.at("default"), "0.05 m");
  EXPECT_EQ(length.at("x-unit"), "m");
  EXPECT_EQ(length.at("anyOf").at(0).at("minimum"), 0.01);
  EXPECT_EQ(length.at("anyOf").at(0).at("maximum"), 1.0);
  EXPECT_EQ(map.at("properties").at("colour").at("enum"), nlohmann::json({"red", "green"}));
  EXPECT_EQ(schema.at("properties").at("gate").at("properties").at("on").at("type"), "boolean");
  EXPECT_EQ(schema.at("properties").at("gate").at("properties").at("count").at("anyOf").at(0).at("type"), "integer");
  EXPECT_TRUE(schema.at("properties").contains("top"));
}

TEST(NearestName, FindsOnlyWhatResembles) {
  constexpr std::array<std::string_view, 3> kNames = {"simplex", "exhaustive", "certified"};
  EXPECT_EQ(nearest_name("simplx", kNames), "simplex");
  EXPECT_EQ(nearest_name("exaustive", kNames), "exhaustive");
  EXPECT_EQ(nearest_name("banana", kNames), std::nullopt);
  EXPECT_EQ(nearest_name("", kNames), std::nullopt);
  EXPECT_EQ(nearest_name(std::string(100000, 'x'), kNames), std::nullopt);
}

}  // namespace
}  // namespace gdtslam
