// When an earlier run counts as beaten: rows made by hand.
#include "tools/lab/bench/against.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

struct RatedRow {
  std::string group;
  double times = 1.0;
};

Against against_of(std::initializer_list<RatedRow> rows) {
  Against against{"before.json", "0.1.0", {}, {}, {}};
  for (const auto& [group, times] : rows) {
    against.rows.push_back({{"cpu", group, "edt", ""},
                            {.middle = times, .least = 0.99 * times, .most = 1.01 * times, .confidence = 0.95}});
  }
  return against;
}

TEST(BenchAgainst, RowsAreAskedButForLimitsAndPeers) {
  const Against fast = against_of({{"kernel", 1.0}, {"limit", 0.1}, {"peer", 0.1}});
  EXPECT_NO_THROW(require_at_least(fast, 0.9));
  EXPECT_THAT(
      [] {
        require_at_least(against_of({{"kernel", 0.5}, {"scan", 1.0}, {"limit", 0.1}}), 0.9);
      },
      ThrowsMessage<Error>(HasSubstr("1 of 2 rows are less than 0.9 times as fast as in before.json: cpu")));
}

TEST(BenchAgainst, NothingComparedIsNothingBeaten) {
  for (const Against& none : {against_of({}), against_of({{"limit", 1.0}, {"peer", 1.0}})}) {
    EXPECT_NO_THROW(require_at_least(none, 0.0)) << "asked for nothing";
    EXPECT_THAT(
        [&none] { require_at_least(none, 0.9); },
        ThrowsMessage<Error>(AllOf(HasSubstr("nothing was compared"), HasSubstr("before.json"), Not(HasSubstr("\n")))));
  }
}

}  // namespace
}  // namespace gdtslam
