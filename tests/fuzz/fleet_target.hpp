// What the fuzzer of an atlas' files calls: its plan, a record, a table of records. A typed error is a right answer; a
// crash, a leak, a hang or any other exception is not. tests/unit/tools replays the corpus.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/record.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::fuzz {

template <class Read>
void expect_typed(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

inline void read_fleet_text(std::span<const std::byte> data) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  expect_typed([&] {
    const FleetPlan plan = parse_plan(text, "fuzz");
    const std::string written = plan_text(plan);
    require(plan_text(parse_plan(written, "written")) == written);
  });
  expect_typed([&] {
    const UnitRecord record = parse_record(text, "fuzz");
    const std::string written = record_text(record);
    require(record_text(parse_record(written, "written")) == written);
    require(run_path(record.run).find("..") == std::string::npos);
  });
  const std::string plan = "0123456789abcdef";
  if (const auto records = parse_records_table(text, plan)) {
    require(parse_records_table(records_table(plan, *records), plan).has_value());
  }
}

}  // namespace gdtslam::fuzz
