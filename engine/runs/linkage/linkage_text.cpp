#include <algorithm>
#include <cmath>

#include "gdtslam/core/angle.hpp"
#include "linkage_file.hpp"

namespace gdtslam {
namespace {

// Centimetres where a round number of them reads back as the same bits, as for the lengths people measure.
std::string length_text(double length_m) {
  constexpr double kDecimals = 1e8;
  const std::string metres = format_quantity(length_m, Unit::kMetre);
  const double length_cm = std::round(length_m * 100.0 * kDecimals) / kDecimals;
  const std::string centimetres = format_quantity(length_cm, Unit::kNone) + " cm";
  const std::optional<double> back = parse_quantity(centimetres, Unit::kMetre, nullptr);
  return back && *back == length_m && centimetres.size() <= metres.size() + 1 ? centimetres : metres;
}

std::string quantity_text(double value, Unit unit) {
  return unit == Unit::kMetre ? length_text(value) : format_quantity(value, unit);
}

// A scalar of YAML that stays text whatever is in it.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    constexpr const char* kHex = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result.append(1, '\\').append(1, c);
    } else if (byte < ' ' || c == '\x7f') {
      result.append("\\x").append(1, kHex[byte >> 4U]).append(1, kHex[byte & 15U]);
    } else {
      result.append(1, c);
    }
  }
  return result + '"';
}

std::string uncertainty_text(const std::vector<ParameterSigma>& uncertainty) {
  std::string lines;
  for (const LinkageParameter& parameter : kLinkageParameters) {
    for (const ParameterSigma& given : uncertainty) {
      if (given.name != parameter.name) continue;
      lines += std::string("  ") + parameter.name + ": " + quantity_text(given.sigma, parameter.unit) + "\n";
    }
  }
  return lines.empty() ? lines : "uncertainty:  # standard deviations\n" + lines;
}

}  // namespace

std::string linkage_text(const calib::SweepModel& model, const std::vector<ParameterSigma>& uncertainty) {
  std::string text = "gdtslam_linkage: 1\nname: " + quoted(model.name) + "\n";
  const auto line = [&text](const char* key, const std::string& value) {
    text.append("  ").append(key).append(": ").append(value).append(1, '\n');
  };
  const auto angle = [](double value_rad) { return format_quantity(value_rad, Unit::kRadian); };
  text += "bars:\n";
  line("crank", length_text(model.bars.crank_m));
  line("coupler", length_text(model.bars.coupler_m));
  line("rocker", length_text(model.bars.rocker_m));
  line("ground", length_text(model.bars.ground_m));
  text += std::string("assembly: ") + (model.assembly == calib::Assembly::kOpen ? "open" : "crossed") + "\n";
  text += "encoder:\n";
  line("ticks_per_turn", std::to_string(model.encoder.ticks_per_turn));
  line("zero", angle(model.encoder.zero_rad) + "  # crank angle at tick 0");
  line("direction", std::to_string(model.encoder.direction) + "  # 1: ticks grow counter-clockwise");
  line("wraps", model.encoder.wraps ? "true" : "false");
  text += "elevation:  # sign * rocker angle + offset\n";
  line("sign", std::to_string(model.elevation_sign));
  line("offset", angle(model.elevation_offset_rad));
  text += "mount:\n";
  line("height", length_text(model.mount.height_m));
  line("lever_forward", length_text(model.mount.lever_forward_m));
  line("lever_up", length_text(model.mount.lever_up_m));
  line("roll", angle(model.mount.sensor_roll_rad));
  line("yaw", angle(model.mount.sensor_yaw_rad));
  text += "laser:\n";
  line("mirror_rate", format_quantity(model.mirror_rate_hz, Unit::kNone) + " Hz");
  line("stamp", format_quantity(model.stamp_share, Unit::kNone) + "  # 0 first beam, 0.5 middle, 1 last");
  return text + uncertainty_text(uncertainty);
}

}  // namespace gdtslam
