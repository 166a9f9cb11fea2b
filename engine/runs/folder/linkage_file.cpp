#include "linkage_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "engine/io/did_you_mean.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/yaml/checked_yaml.hpp"
#include "engine/io/yaml/yaml_text.hpp"
#include "gdtslam/calib/crank_rocker.hpp"

namespace gdtslam {
namespace {

using calib::Assembly;
using calib::SweepModel;

constexpr Quantity kLength{Unit::kMetre};
constexpr Quantity kAngle{Unit::kRadian};
constexpr Quantity kFrequency{Unit::kNone, "Hz"};
constexpr Quantity kShare{Unit::kShare};

/// Reads a linkage; a fault of the whole model is reported at the line of the key that it names.
class LinkageReader {
 public:
  LinkageReader(const std::string& text, const std::string& file)
      : root_(parse_yaml<ConfigError>(text, file), file, ""), file_(file) {}

  LinkageFile read() {
    SweepModel start;
    start.name = std::filesystem::path(file_).stem().string();
    std::string description;
    const auto keep = [this](const YamlValue& section) { sections_.emplace(section.name(), section); };
    read_fields(root_, {required({"gdtslam_linkage", require_version_1}),
                        {"preset", [&](const YamlValue& preset) { start = of_preset(preset); }},
                        {"name", start.name},
                        {"description", description},
                        {"assembly", [&](const YamlValue& name) { start.assembly = assembly_named(name); }},
                        {"bars", keep},
                        {"encoder", keep},
                        {"elevation", keep},
                        {"mount", keep},
                        {"laser", keep},
                        {"uncertainty", keep}});
    read_bars(root_.node()["preset"].IsDefined(), start);
    read_encoder();
    read_elevation();
    read_mount_and_laser();
    read_uncertainty();
    refuse_first(validate(linkage_.model));
    return std::move(linkage_);
  }

 private:
  void refuse_first(const std::vector<std::string>& faults) const {
    if (!faults.empty()) root_.refuse_below(faults.front());
  }

  /// The given keys of a section; none if the file has no such section.
  std::set<std::string> read_section(const char* name, const std::vector<YamlField>& fields) const {
    const auto section = sections_.find(name);
    return section == sections_.end() ? std::set<std::string>() : read_fields(section->second, fields);
  }

  static YamlField whole_field(const char* key, std::int64_t& target) {
    return {key, [&target](const YamlValue& value) {
              constexpr double kMost = 1e15;
              const double number = value.number({});
              if (!(number >= -kMost && number <= kMost) ||
                  number != static_cast<double>(static_cast<std::int64_t>(number))) {
                value.refuse("'" + value.text() + "' is not a whole number");
              }
              target = static_cast<std::int64_t>(number);
            }};
  }

  static YamlField sign_field(const char* key, int& sign) {
    return {key, [&sign](const YamlValue& value) {
              const double number = value.number({});
              if (number != 1.0 && number != -1.0) value.refuse("'" + value.text() + "' must be 1 or -1");
              sign = number > 0.0 ? 1 : -1;
            }};
  }

  static SweepModel of_preset(const YamlValue& preset) {
    try {
      return calib::sweep_model_of_preset(preset.text());
    } catch (const Error& error) {
      preset.refuse(error.what());
    }
  }

  static Assembly assembly_named(const YamlValue& value) {
    const std::string name = value.text();
    if (name != "open" && name != "crossed") {
      value.refuse("unknown assembly '" + name + "'" + did_you_mean(name, {"open", "crossed"}) +
                   "; it is open or crossed");
    }
    return name == "open" ? Assembly::kOpen : Assembly::kCrossed;
  }

  // The lengths give defaults for everything that the file does not state: tick 0 and elevation 0 at the lowest dead
  // point, lifting the slow stroke.
  void read_bars(bool has_preset, SweepModel& start) {
    calib::FourBar& bars = start.bars;
    const std::set<std::string> given = read_section("bars", {{"crank", kLength, bars.crank_m},
                                                              {"coupler", kLength, bars.coupler_m},
                                                              {"rocker", kLength, bars.rocker_m},
                                                              {"ground", kLength, bars.ground_m}});
    if (!has_preset && !sections_.contains("bars")) {
      root_.refuse("bars is missing; give the lengths of crank, coupler, rocker and ground, or a preset");
    }
    for (const char* const missing : {"crank", "coupler", "rocker", "ground"}) {
      if (has_preset || given.contains(missing)) continue;
      root_.refuse_below(
          fmt::format("bars.{0} is missing; give its length with its unit, as in '{0}: 8.5 cm'", missing));
    }
    SweepModel bars_only;
    bars_only.bars = bars;
    refuse_first(validate(bars_only));
    linkage_.model = set_up(start);
  }

  // Bars that form no crank-rocker have no defaults, so the file has to state everything.
  SweepModel set_up(const SweepModel& start) {
    SweepModel model = start;
    try {
      model = calib::sweep_model_of(start.bars, start.assembly);
    } catch (const ConfigError& error) {
      set_up_fault_ = error.what();
    }
    model.name = start.name;
    model.mirror_rate_hz = start.mirror_rate_hz;
    return model;
  }

  void require_without_set_up(bool is_given, const std::string& path) const {
    if (is_given || set_up_fault_.empty()) return;
    root_.refuse_below("bars: " + set_up_fault_ + " (or give " + path + " too)");
  }

  void read_encoder() {
    calib::CrankEncoder& encoder = linkage_.model.encoder;
    const std::set<std::string> given = read_section("encoder", {whole_field("ticks_per_turn", encoder.ticks_per_turn),
                                                                 {"zero", kAngle, encoder.zero_rad},
                                                                 sign_field("direction", encoder.direction),
                                                                 {"wraps", encoder.wraps}});
    require_without_set_up(given.contains("zero"), "encoder.zero");
  }

  void read_elevation() {
    SweepModel& model = linkage_.model;
    const int usual_sign = model.elevation_sign;
    const std::set<std::string> given = read_section(
        "elevation", {sign_field("sign", model.elevation_sign), {"offset", kAngle, model.elevation_offset_rad}});
    const bool has_offset = given.contains("offset");
    if (!has_offset && model.elevation_sign != usual_sign) {
      root_.refuse_below("elevation.offset is missing; with this sign nothing can be supposed for it");
    }
    require_without_set_up(has_offset, "elevation.offset");
  }

  void read_mount_and_laser() {
    NoddingMount& mount = linkage_.model.mount;
    read_section("mount", {{"height", kLength, mount.height_m},
                           {"lever_forward", kLength, mount.lever_forward_m},
                           {"lever_up", kLength, mount.lever_up_m},
                           {"roll", kAngle, mount.sensor_roll_rad},
                           {"yaw", kAngle, mount.sensor_yaw_rad}});
    read_section("laser", {{"mirror_rate", kFrequency, linkage_.model.mirror_rate_hz},
                           {"stamp", kShare, linkage_.model.stamp_share}});
  }

  void read_uncertainty() {
    std::vector<YamlField> fields;
    fields.reserve(kLinkageParameters.size());
    for (const LinkageParameter& parameter : kLinkageParameters) {
      fields.emplace_back(parameter.name, [this, parameter](const YamlValue& given) {
        const double sigma = given.number({parameter.unit});
        if (!(sigma >= 0.0)) given.refuse("a standard deviation is not negative");
        linkage_.uncertainty.push_back({parameter.name, sigma});
      });
    }
    read_section("uncertainty", fields);
  }

  YamlValue root_;
  std::map<std::string, YamlValue> sections_;
  std::string file_;
  std::string set_up_fault_;  ///< why the bars are no crank-rocker; empty if they are one
  LinkageFile linkage_;
};

std::string preset_names() {
  std::string names;
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    names.append(names.empty() ? "" : ", ").append(preset.name);
  }
  return names;
}

// In centimetres if a round number reads back as the same bits, as for lengths that people measure.
std::string exact_length_text(double length_m) {
  constexpr double kDecimals = 1e8;
  const std::string metres = format_quantity(length_m, Unit::kMetre);
  const double length_cm = std::round(length_m * 100.0 * kDecimals) / kDecimals;
  const std::string centimetres = format_quantity(length_cm, Unit::kNone) + " cm";
  const std::optional<double> back = parse_quantity(centimetres, Unit::kMetre, nullptr);
  return back && *back == length_m && centimetres.size() <= metres.size() + 1 ? centimetres : metres;
}

std::string quantity_text(double value, Unit unit) {
  return unit == Unit::kMetre ? exact_length_text(value) : format_quantity(value, unit);
}

// A YAML scalar that always reads back as text.
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

LinkageFile read_linkage_text(const std::string& text, const std::string& file) {
  return LinkageReader(text, file).read();
}

LinkageFile read_linkage_file(const std::string& file) {
  return read_linkage_text(read_text<ConfigError>(file, kMaxYamlBytes), file);
}

SweepModel read_linkage(const std::string& file) { return read_linkage_file(file).model; }

SweepModel resolve_linkage(const std::string& name_or_path) {
  std::vector<std::string> names;
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    if (preset.name == name_or_path) return calib::sweep_model_of_preset(preset.name);
    names.emplace_back(preset.name);
  }
  std::error_code error;
  if (!std::filesystem::exists(name_or_path, error)) {
    throw FileError(name_or_path, "is neither a file nor a linkage preset (" + preset_names() + ")" +
                                      did_you_mean(name_or_path, names));
  }
  return read_linkage(name_or_path);
}

std::string linkage_file_of(const std::string& name_or_path) {
  const auto& presets = calib::linkage_presets();
  const bool is_preset =
      std::any_of(presets.begin(), presets.end(),
                  [&name_or_path](const calib::LinkagePreset& preset) { return preset.name == name_or_path; });
  return is_preset ? std::string() : name_or_path;
}

void write_linkage(const std::string& file, const SweepModel& model, const std::vector<ParameterSigma>& uncertainty) {
  write_file_atomically(file, linkage_text(model, uncertainty));
}

std::string sidecar_path(const std::string& log, const std::string& suffix) {
  std::string_view stem = log;
  for (const std::string_view ending :
       {"/", ".bz2", ".xz", ".zst", ".gz", ".log", ".clf", ".csv", ".jsonl", ".mcap", ".bag", ".db3"}) {
    if (stem.ends_with(ending)) stem.remove_suffix(ending.size());
  }
  return std::string(stem) + suffix;
}

std::string linkage_sidecar(const std::string& log) {
  if (log == "-") return {};
  std::string path = sidecar_path(log, kLinkageSidecar);
  std::error_code none;  // a file that cannot be examined counts as absent
  return std::filesystem::is_regular_file(path, none) ? path : std::string();
}

std::string linkage_text(const calib::SweepModel& model, const std::vector<ParameterSigma>& uncertainty) {
  std::string text = "gdtslam_linkage: 1\nname: " + quoted(model.name) + "\n";
  const auto line = [&text](const char* key, const std::string& value) {
    text.append("  ").append(key).append(": ").append(value).append(1, '\n');
  };
  const auto angle = [](double value_rad) { return format_quantity(value_rad, Unit::kRadian); };
  text += "bars:\n";
  line("crank", exact_length_text(model.bars.crank_m));
  line("coupler", exact_length_text(model.bars.coupler_m));
  line("rocker", exact_length_text(model.bars.rocker_m));
  line("ground", exact_length_text(model.bars.ground_m));
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
  line("height", exact_length_text(model.mount.height_m));
  line("lever_forward", exact_length_text(model.mount.lever_forward_m));
  line("lever_up", exact_length_text(model.mount.lever_up_m));
  line("roll", angle(model.mount.sensor_roll_rad));
  line("yaw", angle(model.mount.sensor_yaw_rad));
  text += "laser:\n";
  line("mirror_rate", format_quantity(model.mirror_rate_hz, Unit::kNone) + " Hz");
  line("stamp", format_quantity(model.stamp_share, Unit::kNone) + "  # 0 first beam, 0.5 middle, 1 last");
  return text + uncertainty_text(uncertainty);
}

}  // namespace gdtslam
