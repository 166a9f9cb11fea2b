// Defaults and bounds of the mapper's options are those of the page that users read.
#include "support/option_page.hpp"

#include <gtest/gtest.h>

#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {
namespace {

TEST(OptionPage, HasTheDefaultsAndBoundsOfTheMapper) {
  MapperConfig mapper;
  test::expect_as_on_the_page(option_table(mapper));
  NoddingConfig nodding;
  test::expect_as_on_the_page(option_table(nodding));
  OccupancyConfig occupancy;
  test::expect_as_on_the_page(option_table(occupancy));
  EXPECT_GT(option_table(mapper).size(), 50U);
}

TEST(OptionPage, DefaultsAreAllowed) {
  MapperConfig mapper;
  EXPECT_TRUE(violations(option_table(mapper)).empty());
  NoddingConfig nodding;
  EXPECT_TRUE(violations(option_table(nodding)).empty());
  OccupancyConfig occupancy;
  EXPECT_TRUE(violations(option_table(occupancy)).empty());
}

}  // namespace
}  // namespace gdtslam
