#include "fuzz/targets.hpp"

#include <cmath>
#include <cstdlib>
#include <string_view>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/carmen.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/pgm.hpp"
#include "gdtslam/io/png.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam::fuzz {
namespace {

/// A broken promise of the readers; ends the program so that the fuzzer sees it.
void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

bool is_one_line(const char* message) { return std::string_view(message).find('\n') == std::string_view::npos; }

void check_record(const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    require(std::isfinite(scan->scan.stamp_s) && scan->T_odom_base->is_finite());
    for (const float range_m : scan->scan.ranges_m) {
      require(range_m >= 0.0F);  // neither negative nor not a number
    }
  }
}

void drain(std::span<const std::byte> data, bool lenient) {
  try {
    const auto reader = open_carmen(data, "fuzz", {.lenient = lenient});
    while (const std::optional<LogRecord> record = reader->next()) {
      check_record(*record);
    }
    require(reader->warnings().size() <= 65);
  } catch (const InputError& error) {
    require(is_one_line(error.what()));
  }
}

}  // namespace

void read_carmen(std::span<const std::byte> data) {
  drain(data, false);
  drain(data, true);
}

void read_config(std::span<const std::byte> data) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  MapperConfig config;
  const std::vector<Option> options = options_of(config);
  try {
    read_config_text(text, "fuzz", options);
    require(violations(options).empty());
    MapperConfig again;
    const std::vector<Option> options_again = options_of(again);
    const std::string written = config_text(options);
    read_config_text(written, "written", options_again);
    require(config_text(options_again) == written);
  } catch (const ConfigError& error) {
    require(is_one_line(error.what()));
  }
}

void read_map_image(std::span<const std::byte> data) {
  try {
    const Grey8Image image = decode_pgm(data, "fuzz");
    require(image.pixels.size() == std::size_t{image.width} * image.height && image.pixels.size() < data.size());
  } catch (const InputError& error) {
    require(is_one_line(error.what()));
  }
}

void read_trajectory(std::span<const std::byte> data) {
  try {
    for (const StampedPose& pose : read_tum(data, "fuzz")) {
      require(pose.T_map_base.is_finite());
    }
  } catch (const InputError& error) {
    require(is_one_line(error.what()));
  }
}

void read_distance_image(std::span<const std::byte> data) {
  try {
    constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 22U;
    const Grey16Image image = decode_png_grey16(data, "fuzz", kMaxPixels);
    require(image.pixels.size() == std::size_t{image.width} * image.height);
  } catch (const InputError& error) {
    require(is_one_line(error.what()));
  }
}

}  // namespace gdtslam::fuzz
