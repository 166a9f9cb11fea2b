// When an earlier run counts as beaten: rows made by hand.
#include "tools/lab/bench/against.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <optional>
#include <string>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
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

Measured measured_on(const std::string& on, const std::string& device, std::optional<Isa> isa, bool has_device_time) {
  BenchRow row;
  row.group = "kernel";
  row.name = "edt";
  row.timing.wall_samples_s = {4.0, 4.0, 4.0, 4.0};
  if (has_device_time) {
    row.timing.device_s = 1.0;
    row.timing.device_samples_s = {1.0, 1.0, 1.0, 1.0};
  }
  Measured measured{on, {}, isa, Basis::kDevice, {row}};
  measured.device.name = device;
  return measured;
}

TEST(BenchAgainst, OnlyTimesOfTheSameClockAreCompared) {
  const EarlierBench before{"before.json", "0.1.0", {{{"vulkan:0", "kernel", "edt", ""}, "device", {2.0, 2.0}}}};
  const Against same = compare_with(before, {measured_on("vulkan:0", "GPU", {}, true)});
  ASSERT_EQ(same.rows.size(), 1U);
  EXPECT_DOUBLE_EQ(same.rows.front().times.middle, 2.0);
  const Against other = compare_with(before, {measured_on("vulkan:0", "GPU", {}, false)});
  EXPECT_TRUE(other.rows.empty());
  EXPECT_EQ(other.only_before.size(), 1U);
  EXPECT_EQ(other.only_now.size(), 1U);
}

TEST(BenchAgainst, AnotherDeviceOrInstructionSetIsTold) {
  const EarlierBench before{
      "before.json", "0.1.0", {}, {{"cpu", "Processor", "avx2"}, {"vulkan:0", "GPU", ""}, {"vulkan:1", "Other", ""}}};
  EXPECT_THAT(other_devices(before, {measured_on("cpu", "Processor", Isa::kAvx2, false),
                                     measured_on("vulkan:0", "GPU", {}, true)}),
              IsEmpty());
  EXPECT_THAT(other_devices(before, {measured_on("cpu", "Processor", Isa::kAvx512, false),
                                     measured_on("vulkan:0", "Big GPU", {}, true)}),
              ElementsAre("cpu was Processor with avx2 in before.json and is Processor with avx512 now",
                          "vulkan:0 was GPU in before.json and is Big GPU now"));
}

}  // namespace
}  // namespace gdtslam
