// The options as docs/reference/options.md and advanced.md state them: default and what is allowed, for tests that hold
// the tables of the code against the page that users read.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "gdtslam/core/units.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam::test {

struct StatedOption {
  std::string standard;  // the default
  std::string allowed;
};

inline std::map<std::string, StatedOption> option_page() {
  std::map<std::string, StatedOption> rows;
  std::stringstream pages;
  for (const char* const name : {"options.md", "advanced.md"}) {
    pages << std::ifstream(std::string(GDTSLAM_SOURCE_DIR "/docs/reference/") + name).rdbuf();
  }
  for (std::string line; std::getline(pages, line);) {
    if (!line.starts_with("| `")) continue;
    std::vector<std::string> cells;
    for (std::size_t at = 2; cells.size() < 3;) {
      const std::size_t end = line.find(" | ", at);
      if (end == std::string::npos) break;
      cells.push_back(line.substr(at, end - at));
      at = end + 3;
    }
    if (cells.size() == 3) rows[cells[0].substr(1, cells[0].size() - 2)] = {cells[1], cells[2]};
  }
  return rows;
}

// The page has six digits of an angle.
inline void expect_quantity(double value, const std::string& stated, Unit unit, std::string_view path) {
  const std::optional<double> expected = parse_quantity(stated, unit, nullptr);
  ASSERT_TRUE(expected.has_value()) << path << ": " << stated;
  EXPECT_NEAR(value, *expected, 1e-5 * std::fabs(*expected)) << path;
}

inline void expect_as_stated(const Option& option, const StatedOption& stated) {
  if (const auto* const on = std::get_if<bool*>(&option.value)) {
    EXPECT_EQ(**on ? "true" : "false", stated.standard) << option.path;
    EXPECT_EQ(stated.allowed, "true or false") << option.path;
    return;
  }
  if (const auto* const choice = std::get_if<Choice>(&option.value)) {
    EXPECT_EQ(choice->get(), stated.standard) << option.path;
    std::string names;
    for (const std::string_view name : choice->names()) names += (names.empty() ? "" : ", ") + std::string(name);
    EXPECT_EQ(names, stated.allowed) << option.path;
    return;
  }
  const auto* const whole = std::get_if<std::int32_t*>(&option.value);
  expect_quantity(whole != nullptr ? **whole : *std::get<double*>(option.value), stated.standard, option.unit,
                  option.path);
  const std::size_t to = stated.allowed.find(" to ");
  ASSERT_NE(to, std::string::npos) << option.path;
  expect_quantity(option.min, stated.allowed.substr(0, to), option.unit, option.path);
  expect_quantity(option.max, stated.allowed.substr(to + 4), option.unit, option.path);
}

/// Each option of the table stands on the page, with the same default and the same bounds.
inline void expect_as_on_the_page(std::span<const Option> table) {
  const std::map<std::string, StatedOption> page = option_page();
  ASSERT_GT(page.size(), 80U);
  for (const Option& option : table) {
    const auto row = page.find(std::string(option.path));
    ASSERT_NE(row, page.end()) << option.path;
    expect_as_stated(option, row->second);
  }
}

}  // namespace gdtslam::test
