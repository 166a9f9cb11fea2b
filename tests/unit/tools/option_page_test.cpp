// Every option of a run stands on the page of options with its default and its bounds, and the page names no other.
#include "support/option_page.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "gdtslam/runs/settings.hpp"

namespace gdtslam {
namespace {

TEST(OptionPageOfARun, HasAllOptionsWithTheirDefaultsAndBounds) {
  Settings settings;
  const std::vector<Option> table = option_table(settings);
  test::expect_as_on_the_page(table);
  std::set<std::string> names;
  for (const Option& option : table) EXPECT_TRUE(names.emplace(option.path).second) << option.path << " is there twice";
  for (const auto& [name, stated] : test::option_page()) EXPECT_EQ(names.count(name), 1U) << name;
}

}  // namespace
}  // namespace gdtslam
