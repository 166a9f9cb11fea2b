// What the fuzzer of linkage files calls; the reader is a source of the command, not of a library. A typed error is a
// right answer; a crash, a leak, a hang or any other exception is not. tests/unit/tools replays the corpus.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string>

#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::fuzz {

inline void read_linkage(std::span<const std::byte> data) {
  const auto require = [](bool holds) {
    if (!holds) std::abort();
  };
  const std::string text(reinterpret_cast<const char*>(data.data()), data.size());
  try {
    const LinkageFile linkage = read_linkage_text(text, "fuzz");
    require(calib::validate(linkage.model).empty());
    const std::string written = linkage_text(linkage.model, linkage.uncertainty);
    const LinkageFile again = read_linkage_text(written, "written");
    require(linkage_text(again.model, again.uncertainty) == written);
    require(again.uncertainty == linkage.uncertainty);
    const ElevationTable table = elevation_table(linkage.model, 6);
    for (const double elevation_rad : table.values_rad()) require(std::isfinite(elevation_rad));
  } catch (const ConfigError& error) {
    require(std::string(error.what()).find('\n') == std::string::npos);
  }
}

}  // namespace gdtslam::fuzz
