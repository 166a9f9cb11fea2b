// Laws of the readers and writers: what is written reads back, and numbers agree with the C library.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>

#include "engine/io/decimal.hpp"
#include "engine/io/logs/carmen.hpp"
#include "engine/io/maps/png.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/units.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

double parsed(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  RC_ASSERT(parse_double(text.data(), end, value) == end);
  return value;
}

RC_GTEST_PROP(DecimalLaws, EveryDoubleReadsBackFromItsShortestText, (std::uint64_t bits)) {
  const double value = std::bit_cast<double>(bits);
  RC_PRE(std::isfinite(value));
  RC_ASSERT(std::bit_cast<std::uint64_t>(parsed(fmt::format("{}", value))) == bits);
}

RC_GTEST_PROP(DecimalLaws, AgreesWithTheCLibraryOnAnyDigits, ()) {
  const auto digits = *rc::gen::container<std::string>(rc::gen::inRange('0', static_cast<char>('9' + 1)));
  RC_PRE(!digits.empty());
  const auto point = *rc::gen::inRange<std::size_t>(0, digits.size() + 1);
  const auto exponent = *rc::gen::inRange(-330, 330);
  std::string text = digits;
  text.insert(point, ".");
  if (*rc::gen::arbitrary<bool>()) {
    text += fmt::format("e{}", exponent);
  }
  if (*rc::gen::arbitrary<bool>()) {
    text.insert(0, "-");
  }
  RC_ASSERT(std::bit_cast<std::uint64_t>(parsed(text)) ==
            std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)));
}

/// A number as logs hold it, with six decimals.
rc::Gen<double> log_number(int limit) {
  return rc::gen::map(rc::gen::inRange(-limit, limit), [](int units) { return static_cast<double>(units) / 1e6; });
}

RC_GTEST_PROP(CarmenLaws, ScansReadBack, ()) {
  const auto hundredths = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 8192));
  RC_PRE(!hundredths.empty());
  const Pose2 T_odom_base{*log_number(100000000), *log_number(100000000), *log_number(3141592)};
  std::string line = fmt::format("FLASER {}", hundredths.size());
  for (const int value : hundredths) {
    line += fmt::format(" {:.2f}", value / 100.0);
  }
  const std::string pose =
      fmt::format(" {:.6f} {:.6f} {:.6f}", T_odom_base.x_m, T_odom_base.y_m, T_odom_base.theta_rad);
  line += pose + pose + " 976052857.337284 host 0.000001\n";
  const auto reader = open_carmen(open_memory_source(bytes_of(line)), "prop", {});
  const auto record = reader->next();
  RC_ASSERT(record.has_value());
  const auto& scan = std::get<ScanRecord>(*record);
  RC_ASSERT(scan.scan.ranges_m.size() == hundredths.size());
  for (std::size_t k = 0; k < hundredths.size(); ++k) {
    RC_ASSERT(scan.scan.ranges_m[k] == static_cast<float>(hundredths[k] / 100.0));
  }
  RC_ASSERT(scan.T_odom_base == T_odom_base);
  RC_ASSERT(scan.scan.T_base_laser == Pose2{});
  RC_ASSERT(!reader->next().has_value());
}

RC_GTEST_PROP(CarmenLaws, MountTakesTheRobotToTheLaser, ()) {
  const Pose2 T_odom_base{*log_number(100000000), *log_number(100000000), *log_number(3141592)};
  const Pose2 T_base_laser{*log_number(1000000), *log_number(1000000), *log_number(3141592)};
  const Pose2 T_odom_laser = T_odom_base * T_base_laser;
  const std::string line = fmt::format("FLASER 1 1.00 {} {} {} {} {} {} 1 h 1\n", T_odom_laser.x_m, T_odom_laser.y_m,
                                       T_odom_laser.theta_rad, T_odom_base.x_m, T_odom_base.y_m, T_odom_base.theta_rad);
  const auto record = open_carmen(open_memory_source(bytes_of(line)), "prop", {})->next();
  const Pose2 found = std::get<ScanRecord>(*record).scan.T_base_laser;
  RC_ASSERT(std::fabs(found.x_m - T_base_laser.x_m) < 1e-9);
  RC_ASSERT(std::fabs(found.y_m - T_base_laser.y_m) < 1e-9);
  RC_ASSERT(std::fabs(wrap_angle(found.theta_rad - T_base_laser.theta_rad)) < 1e-9);
}

RC_GTEST_PROP(TumLaws, PosesReadBackToTheirNineDecimals, ()) {
  Trajectory trajectory;
  const auto count = *rc::gen::inRange(0, 20);
  for (int i = 0; i < count; ++i) {
    trajectory.push_back(
        {*log_number(2000000000), {*log_number(2000000000), *log_number(100000), *log_number(3141592)}});
  }
  const std::string text = tum_text(trajectory);
  const Trajectory read = read_tum(bytes_of(text), "prop");
  RC_ASSERT(read.size() == trajectory.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    RC_ASSERT(std::fabs(read[i].stamp_s - trajectory[i].stamp_s) <= 5.1e-10);
    RC_ASSERT(std::fabs(read[i].T_map_base.x_m - trajectory[i].T_map_base.x_m) <= 5.1e-10);
    RC_ASSERT(std::fabs(read[i].T_map_base.y_m - trajectory[i].T_map_base.y_m) <= 5.1e-10);
    // Two components of half the angle, each rounded to half of 1e-9.
    RC_ASSERT(std::fabs(wrap_angle(read[i].T_map_base.theta_rad - trajectory[i].T_map_base.theta_rad)) <= 3e-9);
  }
}

RC_GTEST_PROP(ImageLaws, PgmAndPngReadBack, ()) {
  const auto width = *rc::gen::inRange<std::uint32_t>(1, 40);
  const auto height = *rc::gen::inRange<std::uint32_t>(1, 40);
  const auto cells =
      *rc::gen::container<std::vector<std::uint16_t>>(width * height, rc::gen::arbitrary<std::uint16_t>());
  Grey8Image grey{width, height, 255, {}};
  for (const std::uint16_t cell : cells) {
    grey.pixels.push_back(static_cast<std::uint8_t>(cell));
  }
  std::string pgm = "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n";
  pgm.append(grey.pixels.begin(), grey.pixels.end());
  RC_ASSERT(decode_pgm(bytes_of(pgm), "prop").pixels == grey.pixels);
  const std::string png = encode_png({width, height, cells});
  const Grey16Image image = decode_png_grey16(bytes_of(png), "prop", 10000);
  RC_ASSERT(image.width == width && image.height == height);
  RC_ASSERT(image.pixels == cells);
}

}  // namespace
}  // namespace gdtslam
