#include "gdtslam/core/error.hpp"

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

TEST(Error, SaysWhere) {
  EXPECT_EQ(located({"a.log", 12}, "range 3 is no number"), "a.log:12: range 3 is no number");
  EXPECT_EQ(located({"a.log", 0}, "is empty"), "a.log: is empty");
}

TEST(Error, CarriesTheExitCode) {
  EXPECT_STREQ(InputError({"a.log", 12}, "bad").what(), "a.log:12: bad");
  EXPECT_STREQ(InputError("bad").what(), "bad");
  EXPECT_EQ(static_cast<int>(InputError("bad").code()), 65);
  EXPECT_EQ(static_cast<int>(UnavailableError("no device").code()), 69);
  EXPECT_EQ(static_cast<int>(FileError("a.log", "cannot be read").code()), 74);
  EXPECT_STREQ(FileError("a.log", "cannot be read").what(), "a.log: cannot be read");
  EXPECT_EQ(static_cast<int>(ConfigError({"c.yaml", 3}, "bad").code()), 78);
  EXPECT_STREQ(ConfigError({"c.yaml", 3}, "bad").what(), "c.yaml:3: bad");
  EXPECT_EQ(static_cast<int>(UsageError("no log given").code()), 2);
}

}  // namespace
}  // namespace gdtslam
