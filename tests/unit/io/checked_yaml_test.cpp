// Values of YAML files by their rules and limits: each refusal names the file, the line and the value.
#include "engine/io/yaml/checked_yaml.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "engine/io/file_limits.hpp"
#include "engine/io/yaml/yaml_file.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

using ::testing::HasSubstr;

YamlValue yaml_value(const std::string& text, const std::string& name = "") {
  return {YAML::Load(text), "a.yaml", name};
}

template <class Failure = ConfigError, class Read>
std::string yaml_refusal(const Read& read) {
  return told_by<Failure>(read);
}

TEST(YamlValue, AnglesOtherThanZeroNeedTheirUnit) {
  const Quantity angle{Unit::kRadian};
  const Quantity rate{Unit::kRadian, "/s"};
  EXPECT_EQ(yaml_value("0").number(angle), 0.0);
  EXPECT_EQ(yaml_value("-0.0").number(angle), 0.0);
  EXPECT_DOUBLE_EQ(yaml_value("180 deg").number(angle), kPi);
  EXPECT_EQ(yaml_value("0.5 rad").number(angle), 0.5);
  EXPECT_EQ(yaml_value("0.5 rad/s").number(rate), 0.5);
  EXPECT_EQ(yaml_value("0.5 rad").number(rate), 0.5);
  for (const char* const bare : {"90", "-1.5e0", "1"}) {
    EXPECT_THAT(yaml_refusal([&] { (void)yaml_value(bare, "tilt").number(angle); }),
                HasSubstr(fmt::format("tilt: an angle needs its unit: write '{0} deg' or '{0} rad'", bare)));
    EXPECT_NE(yaml_refusal([&] { (void)yaml_value(std::string(bare) + "/s").number(rate); }), "");
  }
  EXPECT_EQ(yaml_value("90").number({Unit::kMetre}), 90.0);
  EXPECT_EQ(yaml_value("10 Hz").number({Unit::kNone, "Hz"}), 10.0);
}

TEST(YamlValue, EntriesAreNumberedAndAtMost100000) {
  const std::vector<YamlValue> entries = yaml_value("[a, b, c]", "walls").entries();
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[0].name(), "walls[0]");
  EXPECT_EQ(entries[2].name(), "walls[2]");
  EXPECT_EQ(entries[2].text(), "c");
  YAML::Node list;
  for (int k = 0; k < 100000; ++k) list.push_back(0);
  EXPECT_EQ(YamlValue(list, "a.yaml", "x").entries().size(), 100000U);
  list.push_back(0);
  EXPECT_THAT(yaml_refusal([&] { (void)YamlValue(list, "a.yaml", "x").entries(); }),
              HasSubstr("x: a list of more than 100000 entries is not accepted"));
  EXPECT_THAT(yaml_refusal([] { (void)yaml_value("a", "x").entries(); }), HasSubstr("a list is expected here"));
}

TEST(ReadFields, ReadsWhatIsGivenAndRefusesOtherKeys) {
  double width_m = 9.0;
  double height_m = 9.0;
  std::string name = "none";
  bool is_on = true;
  const std::vector<YamlField> fields{{"width", {Unit::kMetre}, width_m},
                                      {"height", {Unit::kMetre}, height_m},
                                      required({"name", name}),
                                      {"on", is_on}};
  const auto given = read_fields(yaml_value("{width: 2 m, name: room, on: false}", "room"), fields);
  EXPECT_THAT(given, ::testing::ElementsAre("name", "on", "width"));
  EXPECT_EQ(width_m, 2.0);
  EXPECT_EQ(height_m, 9.0) << "stays";
  EXPECT_EQ(name, "room");
  EXPECT_FALSE(is_on);
  const auto refusal = [&](const std::string& text) {
    return yaml_refusal([&] { read_fields(yaml_value(text, "room"), fields); });
  };
  EXPECT_THAT(refusal("{width: 2 m}"), HasSubstr("room: the key 'name' is missing"));
  EXPECT_EQ(refusal("name: a\nwidht: 2 m\n"), "a.yaml:2: room: unknown key 'widht'; did you mean 'width'?");
  EXPECT_THAT(refusal("{name: a, width: x}"), HasSubstr("room.width: 'x' is no value for this"));
  EXPECT_THAT(refusal("[a]"), HasSubstr("room: keys with values are expected here"));
  EXPECT_EQ(refusal("name: a\non: true\nname: b\n"), "a.yaml:3: room: the key 'name' stands twice");
  EXPECT_EQ(refusal("name: a\non:\n"), "a.yaml:2: room: the key 'on' has no value");
}

bool is_read(const std::string& text) {
  return yaml_refusal<InputError>([&] { (void)parse_yaml<InputError>(text, "a.yaml"); }).empty();
}

// docs/formats.md: nested 32 deep, 1,000,000 values.
TEST(YamlText, IsNested32DeepAtMost) {
  EXPECT_TRUE(is_read(std::string(32, '[') + std::string(32, ']')));
  EXPECT_FALSE(is_read(std::string(33, '[') + std::string(33, ']')));
  EXPECT_TRUE(is_read(std::string(31, '[') + "{a: 1}" + std::string(31, ']')));
  EXPECT_FALSE(is_read(std::string(32, '[') + "{a: 1}" + std::string(32, ']')));
  std::string beside = "[";
  for (int k = 0; k < 100; ++k) beside += "[{a: 1}], ";
  EXPECT_TRUE(is_read(beside + "1]")) << "what is closed again counts no more";
  EXPECT_FALSE(is_read("a: 1\n---\nb: 2\n")) << "two documents";
  EXPECT_TRUE(is_read("---\na: 1\n"));
}

// YAML 1.1 knows a number by its point.
TEST(DescriptionFile, WrittenNumbersHaveAPoint) {
  EXPECT_EQ(yaml_number(1.0), "1.0");
  EXPECT_EQ(yaml_number(-0.25), "-0.25");
  EXPECT_EQ(yaml_number(1e-7), "1.0e-07");
  EXPECT_EQ(yaml_number(1.5e-7), "1.5e-07");
  EXPECT_EQ(yaml_number(1e30), "1.0e+30");
}

}  // namespace
}  // namespace gdtslam
