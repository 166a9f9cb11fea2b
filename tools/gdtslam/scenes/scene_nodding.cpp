#include "scene_nodding.hpp"

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr Quantity kLength{Unit::kMetre};
constexpr Quantity kAngle{Unit::kRadian};
constexpr Quantity kTime{Unit::kSecond};
constexpr Quantity kFrequency{Unit::kNone, "Hz"};

constexpr std::array<std::pair<const char*, sim::NodMode>, 3> kModes{{{"continuous", sim::NodMode::kContinuous},
                                                                      {"stop-and-scan", sim::NodMode::kStopAndScan},
                                                                      {"stepped", sim::NodMode::kStepped}}};

constexpr std::array<std::pair<const char*, sim::EncoderFaultKind>, 4> kFaults{
    {{"stop", sim::EncoderFaultKind::kStop},
     {"jump", sim::EncoderFaultKind::kJump},
     {"backwards", sim::EncoderFaultKind::kBackwards},
     {"missing", sim::EncoderFaultKind::kMissing}}};

template <class Names>
std::vector<std::string> names_of(const Names& names) {
  std::vector<std::string> list;
  list.reserve(names.size());
  for (const auto& entry : names) list.emplace_back(entry.first);
  return list;
}

template <class Value, class Names>
Value named(const YamlValue& value, const Names& names, const char* what) {
  for (const auto& [name, known] : names) {
    if (value.text() == name) {
      return known;
    }
  }
  value.refuse("unknown " + std::string(what) + " '" + value.text() + "'" +
               did_you_mean(value.text(), names_of(names)));
}

std::int64_t whole(const YamlValue& value, double least, double most) {
  const double number = value.number(Quantity{Unit::kNone});
  if (!(number >= least && number <= most) || static_cast<double>(static_cast<std::int64_t>(number)) != number) {
    value.refuse("'" + value.text() + "' is no whole number of the allowed range");
  }
  return static_cast<std::int64_t>(number);
}

calib::SweepModel read_linkage_name(const YamlValue& value) {
  if (const std::string fault = fault_of_reference(value.file(), value.text()); !fault.empty()) {
    value.refuse(fault);
  }
  const std::string beside = referenced_path(value.file(), value.text());
  if (std::filesystem::exists(beside)) {
    return read_linkage(beside);
  }
  try {
    return calib::sweep_model_of_preset(value.text());
  } catch (const Error& error) {
    value.refuse(std::string(error.what()) + "; nor is it a file beside the scene");
  }
}

void read_encoder(const YamlValue& value, sim::NoddingModel& nodding) {
  YamlMapping mapping(value);
  calib::CrankEncoder& encoder = nodding.truth.encoder;
  mapping.read("rate", kFrequency, nodding.encoder_rate_hz);
  mapping.read("wraps", encoder.wraps);
  if (const auto ticks = mapping.find("ticks_per_turn")) {
    encoder.ticks_per_turn = whole(*ticks, 1.0, static_cast<double>(std::int64_t{1} << 30));
  }
  bool is_exact = false;
  mapping.read("exact", is_exact);
  if (is_exact) {
    make_exact(encoder);
  }
  mapping.finish();
}

sim::EncoderFault read_fault(const YamlValue& value) {
  YamlMapping mapping(value);
  sim::EncoderFault fault;
  fault.kind = named<sim::EncoderFaultKind>(mapping.require("kind"), kFaults, "fault");
  fault.from_s = mapping.require("from").number(kTime);
  if (fault.kind == sim::EncoderFaultKind::kJump) {
    constexpr double kMost = 1099511627776.0;  // 2^40
    fault.ticks = whole(mapping.require("ticks"), -kMost, kMost);
  } else {
    mapping.read("to", kTime, fault.to_s);
  }
  mapping.finish();
  return fault;
}

void read_mount(YamlMapping& mapping, NoddingMount& mount) {
  if (const auto lever = mapping.find("lever")) {
    YamlMapping arm(*lever);
    arm.read("forward", kLength, mount.lever_forward_m);
    arm.read("up", kLength, mount.lever_up_m);
    arm.finish();
  }
  if (const auto sensor = mapping.find("sensor")) {
    YamlMapping angles(*sensor);
    angles.read("roll", kAngle, mount.sensor_roll_rad);
    angles.read("yaw", kAngle, mount.sensor_yaw_rad);
    angles.finish();
  }
}

}  // namespace

sim::NodMode nod_mode(const std::string& name) {
  for (const auto& [known, mode] : kModes) {
    if (name == known) {
      return mode;
    }
  }
  throw UsageError("unknown mode '" + name + "' of nodding" + did_you_mean(name, names_of(kModes)) +
                   "; there are continuous, stop-and-scan and stepped");
}

void make_exact(calib::CrankEncoder& encoder) { encoder.ticks_per_turn = std::int64_t{1} << 30; }

sim::NoddingModel read_nodding(const YamlValue& value) {
  YamlMapping mapping(value);
  sim::NoddingModel nodding;
  const auto linkage = mapping.find("linkage");
  nodding.truth = linkage ? read_linkage_name(*linkage) : calib::sweep_model_of_preset(calib::kDefaultLinkage);
  if (const auto mode = mapping.find("mode")) {
    nodding.mode = named<sim::NodMode>(*mode, kModes, "mode");
  }
  mapping.read("crank_rate", kFrequency, nodding.crank_rate_hz);
  double start_rad = 0.0;
  mapping.read("start", kAngle, start_rad);
  nodding.start_turns = start_rad / kTwoPi;
  mapping.read("step", kAngle, nodding.step_rad);
  mapping.read("stop", kTime, nodding.stop_s);
  if (const auto turns = mapping.find("turns")) {
    nodding.turns_a_stop = static_cast<int>(whole(*turns, 1.0, 1000.0));
  }
  mapping.read("stop_every", kLength, nodding.stop_every_m);
  if (const auto encoder = mapping.find("encoder")) {
    read_encoder(*encoder, nodding);
  }
  read_mount(mapping, nodding.truth.mount);
  for (const YamlValue& fault : mapping.list("encoder_faults")) {
    nodding.faults.push_back(read_fault(fault));
  }
  mapping.finish();
  value.require_none(validate(nodding));
  return nodding;
}

}  // namespace gdtslam
