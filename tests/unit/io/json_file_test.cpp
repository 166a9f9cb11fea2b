// JSON files that others wrote: read, or refused with one line before they cost memory.
#include "engine/io/json_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "gdtslam/core/error.hpp"
#include "io_test_support.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostBytes = std::size_t{64} << 20U;

class JsonFileTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path() const { return (folder_.path() / "a.json").string(); }
  nlohmann::ordered_json read(const std::string& text, std::size_t most_bytes = kMostBytes) const {
    std::ofstream(path()) << text;
    return read_json(path(), most_bytes, "; do that");
  }
  void expect_refused(const std::string& text, const std::string& message, std::size_t most_bytes = kMostBytes) const {
    try {
      read(text, most_bytes);
      ADD_FAILURE() << "was read: " << text.substr(0, 40);
    } catch (const InputError& error) {
      EXPECT_EQ(error.what(), path() + message + "; do that");
    }
  }
  TemporaryFolder folder_;
};

std::string times(std::size_t count, const std::string& piece) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += piece;
  return text;
}

TEST_F(JsonFileTest, ReadsBackWhatIsWritten) {
  const nlohmann::ordered_json value{{"b", {1, -2.5, nullptr, true}}, {"a", "text, [[[\"{\\ \u00e4"}};
  write_json(path(), value);
  EXPECT_EQ(read_json(path(), kMostBytes), value);
}

TEST_F(JsonFileTest, SaysInWhichLineTheJsonEnds) {
  expect_refused("", ":1: is no JSON text");
  expect_refused("{\n\"a\": 1,\n\"b\": x\n}\n", ":3: is no JSON text");
  expect_refused("[1, 2", ":1: is no JSON text");
  expect_refused("{} {}", ":1: is no JSON text");
  expect_refused("[\"\xff\"]", ":1: is no JSON text");
}

TEST_F(JsonFileTest, BoundsDepth) {
  EXPECT_EQ(read(times(16, "[") + times(16, "]")).size(), 1U);
  expect_refused(times(17, "[") + times(17, "]"), ": is nested deeper than the 16 levels that are read");
  expect_refused(times(17, "{\"a\":"), ": is nested deeper than the 16 levels that are read");
  expect_refused(times(1U << 20U, "["), ": is nested deeper than the 16 levels that are read");
  EXPECT_EQ(read("[\"" + times(40, "[{\\\"") + "\"]").size(), 1U);         // brackets in texts nest nothing
  EXPECT_EQ(read("[\"\\\\\", [" + times(40, "[],") + "[]]]").size(), 2U);  // nor do those that are closed
}

TEST_F(JsonFileTest, BoundsValues) {
  EXPECT_EQ(read("[" + times(1'000'000, "0,") + "0]").size(), 1'000'001U);
  expect_refused("[" + times(2'500'000, "0,") + "0]", ": holds more than the 2500000 values that are read");
  expect_refused("[" + times(1'300'000, "{},") + "0]", ": holds more than the 2500000 values that are read");
}

TEST_F(JsonFileTest, BoundsMembersOfAnObject) {
  const auto object_of = [](int members) {
    std::string text = "{\"a\": {\"colons: \": \"::\"}";
    for (int k = 1; k < members; ++k) text += ", \"" + std::to_string(k) + "\": [{}]";
    return text + "}";
  };
  EXPECT_EQ(read(object_of(256)).size(), 256U);
  EXPECT_EQ(read("[" + object_of(200) + "," + object_of(200) + "]").size(), 2U);  // each is counted by itself
  expect_refused(object_of(257), ": has an object of more than the 256 members that are read");
  expect_refused("[[" + object_of(300'000) + "]]", ": has an object of more than the 256 members that are read");
}

TEST_F(JsonFileTest, BoundsBytes) {
  EXPECT_EQ(read("[1, 2]", 6).size(), 2U);
  expect_refused("[1, 2] ", ": is longer than the 6 bytes that are read", 6);
}

TEST(JsonFile, NumbersReadBackAndTextIsMadeUtf8) {
  const nlohmann::ordered_json value = {{"z", 0.1},
                                        {"a", std::nan("")},
                                        {"path",
                                         "bad\xff"
                                         "byte"}};
  const std::string text = json_text(value);
  EXPECT_EQ(text, "{\n  \"z\": 0.1,\n  \"a\": null,\n  \"path\": \"bad\\ufffdbyte\"\n}\n");
  const TemporaryFolder folder;
  write_json(folder / "r.json", value);
  EXPECT_EQ(get_file(folder / "r.json"), text);
}

// A report of 3,000 keyframes and many doubtful scans is read by people, too.
TEST(JsonFile, ListsOfNumbersAndRowsOfTablesAreOneLineEach) {
  nlohmann::ordered_json value{{"origin_m", {0.5, -1}},
                               {"inner", {{"a", 1}, {"empty", nlohmann::ordered_json::array()}}},
                               {"rows", {{{"scan", 7}, {"at", {1, 2}}}, {{"scan", 9}, {"at", {3, 4}}}}},
                               {"texts", {"one", "two"}},
                               {"long", {std::string(70, 'x'), std::string(70, 'y')}},
                               {"deep", {{{"a", {{"b", 1}}}}}}};
  EXPECT_EQ(json_text(value),
            "{\n"
            "  \"origin_m\": [0.5, -1],\n"
            "  \"inner\": {\n    \"a\": 1,\n    \"empty\": []\n  },\n"
            "  \"rows\": [\n    {\"scan\": 7, \"at\": [1, 2]},\n"
            "    {\"scan\": 9, \"at\": [3, 4]}\n  ],\n"
            "  \"texts\": [\"one\", \"two\"],\n"
            "  \"long\": [\n    \"" +
                std::string(70, 'x') + "\",\n    \"" + std::string(70, 'y') +
                "\"\n  ],\n"
                "  \"deep\": [\n    {\n      \"a\": {\n        \"b\": 1\n      }\n    }\n  ]\n"
                "}\n");
  value = nlohmann::ordered_json::object();
  for (int k = 0; k < 3000; ++k) value["keyframe_scans"].push_back(k);
  const std::string text = json_text(value);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_EQ(parse_json(text, "it"), value);
}

TEST(JsonFile, LettersThatATerminalMayObeyAreEscaped) {
  const std::string text = "\x7f \xc2\x9b \xe2\x80\xa8 \xc3\xbc";
  EXPECT_EQ(json_text(text), "\"\\u007f \\u009b \\u2028 \\u00fc\"\n");
  EXPECT_EQ(parse_json(json_text(text), "it"), text);
}

}  // namespace
}  // namespace gdtslam
