#include "linkage_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
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

// Reads a linkage and remembers where each value stood, so that a fault of the whole model is reported at its line.
class LinkageReader {
 public:
  LinkageReader(const std::string& text, const std::string& file)
      : root_(YamlValue(parse_yaml<ConfigError>(text, file), file, "")), file_(file) {}

  LinkageFile read() {
    const YamlValue version = root_.require("gdtslam_linkage");
    if (version.text() != "1") {
      version.refuse("version '" + version.text() + "' is not known; this program reads version 1");
    }
    read_bars();
    read_encoder();
    read_elevation();
    read_mount();
    read_laser();
    read_uncertainty();
    std::string description;
    root_.read("description", description);
    root_.finish();
    refuse_first(validate(linkage_.model));
    return std::move(linkage_);
  }

 private:
  struct Place {
    std::string path;
    YamlValue value;
  };

  [[noreturn]] void refuse_at(const YamlValue& value, const std::string& fault) const {
    YamlValue(value.node(), file_, "").refuse(fault);  // the fault names its path itself
  }

  // At the value that the fault begins with, else at its section.
  void refuse_first(const std::vector<std::string>& faults) const {
    if (faults.empty()) return;
    const Place* nearest = nullptr;
    for (const Place& place : places_) {
      const bool is_named = faults.front().starts_with(place.path);
      if (is_named && (nearest == nullptr || place.path.size() > nearest->path.size())) nearest = &place;
    }
    refuse_at(nearest != nullptr ? nearest->value : root_.value(), faults.front());
  }

  std::optional<YamlValue> find(YamlMapping& section, const std::string& key) {
    std::optional<YamlValue> value = section.find(key);
    if (value) places_.push_back({value->name(), *value});
    return value;
  }

  bool read_into(YamlMapping& section, const std::string& key, const Quantity& quantity, double& target) {
    const std::optional<YamlValue> value = find(section, key);
    if (value) target = value->number(quantity);
    return value.has_value();
  }

  void read_whole(YamlMapping& section, const std::string& key, std::int64_t& target) {
    constexpr double kMost = 1e15;
    const std::optional<YamlValue> value = find(section, key);
    if (!value) return;
    const double number = value->number({});
    if (!(number >= -kMost && number <= kMost) || number != static_cast<double>(static_cast<std::int64_t>(number))) {
      value->refuse("'" + value->text() + "' is not a whole number");
    }
    target = static_cast<std::int64_t>(number);
  }

  void read_sign(YamlMapping& section, const std::string& key, int& sign) {
    const std::optional<YamlValue> value = find(section, key);
    if (!value) return;
    const double number = value->number({});
    if (number != 1.0 && number != -1.0) value->refuse("'" + value->text() + "' must be 1 or -1");
    sign = number > 0.0 ? 1 : -1;
  }

  // The lengths decide what everything else is unless the file says so: tick 0 and elevation 0 at the lowest dead
  // point, lifting the slow stroke.
  void read_bars() {
    const std::optional<YamlValue> preset = find(root_, "preset");
    SweepModel start;
    start.name = std::filesystem::path(file_).stem().string();
    if (preset) start = of_preset(*preset);
    root_.read("name", start.name);
    read_assembly(start.assembly);
    if (const std::optional<YamlValue> value = find(root_, "bars")) {
      read_lengths(*value, preset.has_value(), start.bars);
    } else if (!preset) {
      refuse_at(root_.value(), "bars is missing; give the lengths of crank, coupler, rocker and ground, or a preset");
    }
    SweepModel bars_only;
    bars_only.bars = start.bars;
    refuse_first(validate(bars_only));
    linkage_.model = set_up(start);
  }

  static SweepModel of_preset(const YamlValue& preset) {
    try {
      return calib::sweep_model_of_preset(preset.text());
    } catch (const Error& error) {
      preset.refuse(error.what());
    }
  }

  void read_assembly(Assembly& assembly) {
    const std::optional<YamlValue> value = find(root_, "assembly");
    if (!value) return;
    const std::string name = value->text();
    if (name != "open" && name != "crossed") {
      value->refuse("unknown assembly '" + name + "'" + did_you_mean(name, {"open", "crossed"}) +
                    "; it is open or crossed");
    }
    assembly = name == "open" ? Assembly::kOpen : Assembly::kCrossed;
  }

  void read_lengths(const YamlValue& value, bool has_preset, calib::FourBar& bars) {
    YamlMapping section(value);
    const std::array<std::pair<const char*, double*>, 4> lengths{{{"crank", &bars.crank_m},
                                                                  {"coupler", &bars.coupler_m},
                                                                  {"rocker", &bars.rocker_m},
                                                                  {"ground", &bars.ground_m}}};
    std::string missing;
    for (const auto& [name, length] : lengths) {
      if (!read_into(section, name, kLength, *length) && missing.empty()) missing = name;
    }
    section.finish();  // a misspelt bar is named as that
    if (!has_preset && !missing.empty()) {
      refuse_at(value,
                "bars." + missing + " is missing; give its length with its unit, as in '" + missing + ": 8.5 cm'");
    }
  }

  // Where the bars are no crank-rocker nothing can be supposed, and the file has to say it all.
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
    refuse_first({"bars: " + set_up_fault_ + " (or give " + path + " too)"});
  }

  void read_encoder() {
    calib::CrankEncoder& encoder = linkage_.model.encoder;
    bool has_zero = false;
    if (const std::optional<YamlValue> value = find(root_, "encoder")) {
      YamlMapping section(*value);
      read_whole(section, "ticks_per_turn", encoder.ticks_per_turn);
      has_zero = read_into(section, "zero", kAngle, encoder.zero_rad);
      read_sign(section, "direction", encoder.direction);
      section.read("wraps", encoder.wraps);
      section.finish();
    }
    require_without_set_up(has_zero, "encoder.zero");
  }

  void read_elevation() {
    SweepModel& model = linkage_.model;
    bool has_offset = false;
    const int usual_sign = model.elevation_sign;
    if (const std::optional<YamlValue> value = find(root_, "elevation")) {
      YamlMapping section(*value);
      read_sign(section, "sign", model.elevation_sign);
      has_offset = read_into(section, "offset", kAngle, model.elevation_offset_rad);
      section.finish();
      if (!has_offset && model.elevation_sign != usual_sign) {
        refuse_at(*value, "elevation.offset is missing; with this sign nothing can be supposed for it");
      }
    }
    require_without_set_up(has_offset, "elevation.offset");
  }

  void read_mount() {
    const std::optional<YamlValue> value = find(root_, "mount");
    if (!value) return;
    NoddingMount& mount = linkage_.model.mount;
    YamlMapping section(*value);
    read_into(section, "height", kLength, mount.height_m);
    read_into(section, "lever_forward", kLength, mount.lever_forward_m);
    read_into(section, "lever_up", kLength, mount.lever_up_m);
    read_into(section, "roll", kAngle, mount.sensor_roll_rad);
    read_into(section, "yaw", kAngle, mount.sensor_yaw_rad);
    section.finish();
  }

  void read_laser() {
    const std::optional<YamlValue> value = find(root_, "laser");
    if (!value) return;
    YamlMapping section(*value);
    read_into(section, "mirror_rate", kFrequency, linkage_.model.mirror_rate_hz);
    read_into(section, "stamp", kShare, linkage_.model.stamp_share);
    section.finish();
  }

  void read_uncertainty() {
    const std::optional<YamlValue> value = root_.find("uncertainty");
    if (!value) return;
    YamlMapping section(*value);
    for (const LinkageParameter& parameter : kLinkageParameters) {
      const std::optional<YamlValue> given = section.find(parameter.name);
      if (!given) continue;
      const double sigma = given->number({parameter.unit});
      if (!(sigma >= 0.0)) given->refuse("a standard deviation is not negative");
      linkage_.uncertainty.push_back({parameter.name, sigma});
    }
    section.finish();
  }

  YamlMapping root_;
  std::string file_;
  std::string set_up_fault_;  ///< why the bars are no crank-rocker; empty when they are
  LinkageFile linkage_;
  std::vector<Place> places_;
};

std::string preset_names() {
  std::string names;
  for (const calib::LinkagePreset& preset : calib::linkage_presets()) {
    names.append(names.empty() ? "" : ", ").append(preset.name);
  }
  return names;
}

// Centimetres where a round number of them reads back as the same bits, as for the lengths people measure.
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
  std::error_code none;  // what cannot be looked at is not there
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
