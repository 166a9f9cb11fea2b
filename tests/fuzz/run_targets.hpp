// Linkages.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

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

inline constexpr std::array kRunTargets{
    FuzzTarget{"linkage", read_linkage_description, 12},
};

}  // namespace gdtslam::fuzz
