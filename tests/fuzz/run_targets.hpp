// Linkages, and the plan and records of an atlas.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/record.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {

inline void read_linkage_description(std::span<const std::byte> data) {
  expect_typed<ConfigError>([&] {
    const LinkageFile linkage = read_linkage_text(std::string(text_of(data)), "fuzz");
    require(calib::validate(linkage.model).empty());
    const std::string written = linkage_text(linkage.model, linkage.uncertainty);
    const LinkageFile again = read_linkage_text(written, "written");
    require(linkage_text(again.model, again.uncertainty) == written);
    require(again.uncertainty == linkage.uncertainty);
    const ElevationTable table = elevation_table(linkage.model, 6);
    for (const double elevation_rad : table.values_rad()) require(std::isfinite(elevation_rad));
  });
}

/// The plan of an atlas, a record, a table of records.
inline void read_fleet_text(std::span<const std::byte> data) {
  const std::string_view text = text_of(data);
  expect_typed<InputError>([&] {
    const FleetPlan plan = parse_plan(text, "fuzz");
    const std::string written = plan_text(plan);
    require(plan_text(parse_plan(written, "written")) == written);
  });
  expect_typed<InputError>([&] {
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

inline constexpr std::array kRunTargets{
    FuzzTarget{"linkage", read_linkage_description, 12},
    FuzzTarget{"fleet", read_fleet_text, 8},
};

}  // namespace gdtslam::fuzz
