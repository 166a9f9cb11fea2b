#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/referenced_file.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "scene_parts.hpp"

namespace gdtslam {
namespace {

constexpr std::array<std::pair<const char*, sim::NodMode>, 3> kModes{{{"continuous", sim::NodMode::kContinuous},
                                                                      {"stop-and-scan", sim::NodMode::kStopAndScan},
                                                                      {"stepped", sim::NodMode::kStepped}}};

constexpr std::array<std::pair<const char*, sim::EncoderFaultKind>, 4> kFaults{
    {{"stop", sim::EncoderFaultKind::kStop},
     {"jump", sim::EncoderFaultKind::kJump},
     {"backwards", sim::EncoderFaultKind::kBackwards},
     {"missing", sim::EncoderFaultKind::kMissing}}};

template <class Names>
std::vector<std::string> list_names(const Names& names) {
  std::vector<std::string> list;
  list.reserve(names.size());
  for (const auto& entry : names) list.emplace_back(entry.first);
  return list;
}

// Finds the value with that name; empty if there is none.
template <class Names>
auto find_named(const Names& names, const std::string& name) {
  const auto found = std::find_if(names.begin(), names.end(), [&](const auto& entry) { return name == entry.first; });
  return found != names.end() ? std::optional(found->second) : std::nullopt;
}

template <class Names>
auto named(const YamlValue& value, const Names& names, const char* what) {
  if (const auto known = find_named(names, value.text())) return *known;
  value.refuse("unknown " + std::string(what) + " '" + value.text() + "'" +
               did_you_mean(value.text(), list_names(names)));
}

std::int64_t whole(const YamlValue& value, double least, double most) {
  const double number = value.number(kNumber);
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
  calib::CrankEncoder& encoder = nodding.truth.encoder;
  bool is_exact = false;
  const auto read_ticks = [&](const YamlValue& ticks) {
    encoder.ticks_per_turn = whole(ticks, 1.0, static_cast<double>(std::int64_t{1} << 30));
  };
  read_fields(value, {{"rate", kFrequency, nodding.encoder_rate_hz},
                      {"wraps", encoder.wraps},
                      {"ticks_per_turn", read_ticks},
                      {"exact", is_exact}});
  if (is_exact) make_exact(encoder);
}

sim::EncoderFault read_fault(const YamlValue& value) {
  constexpr double kMost = 1099511627776.0;  // 2^40
  sim::EncoderFault fault;
  const std::set<std::string> given = read_fields(
      value, {required({"kind", [&](const YamlValue& kind) { fault.kind = named(kind, kFaults, "fault"); }}),
              required({"from", kTime, fault.from_s}),
              {"to", kTime, fault.to_s},
              {"ticks", [&](const YamlValue& ticks) { fault.ticks = whole(ticks, -kMost, kMost); }}});
  const bool is_jump = fault.kind == sim::EncoderFaultKind::kJump;
  if (is_jump != given.contains("ticks") || (is_jump && given.contains("to"))) {
    value.refuse("a jump has ticks and no end, other faults have no ticks");
  }
  return fault;
}

}  // namespace

sim::NodMode nod_mode(const std::string& name) {
  if (const auto mode = find_named(kModes, name)) return *mode;
  throw UsageError("unknown mode '" + name + "' of nodding" + did_you_mean(name, list_names(kModes)) +
                   "; there are continuous, stop-and-scan and stepped");
}

void make_exact(calib::CrankEncoder& encoder) { encoder.ticks_per_turn = std::int64_t{1} << 30; }

sim::NoddingModel read_nodding(const YamlValue& value) {
  sim::NoddingModel nodding;
  nodding.truth = calib::sweep_model_of_preset(calib::kDefaultLinkage);
  NoddingMount& mount = nodding.truth.mount;
  double start_rad = 0.0;
  const auto read_lever = [&](const YamlValue& lever) {
    read_fields(lever, {{"forward", kLength, mount.lever_forward_m}, {"up", kLength, mount.lever_up_m}});
  };
  const auto read_sensor = [&](const YamlValue& sensor) {
    read_fields(sensor, {{"roll", kAngle, mount.sensor_roll_rad}, {"yaw", kAngle, mount.sensor_yaw_rad}});
  };
  const auto read_faults = [&](const YamlValue& list) {
    for (const YamlValue& fault : list.entries()) nodding.faults.push_back(read_fault(fault));
  };
  read_fields(value,
              {{"linkage", [&](const YamlValue& linkage) { nodding.truth = read_linkage_name(linkage); }},
               {"mode", [&](const YamlValue& mode) { nodding.mode = named(mode, kModes, "mode"); }},
               {"elevation_error", kAngle, nodding.elevation_error_rad},
               {"crank_rate", kFrequency, nodding.crank_rate_hz},
               {"start", kAngle, start_rad},
               {"step", kAngle, nodding.step_rad},
               {"stop", kTime, nodding.stop_s},
               {"turns", [&](const YamlValue& n) { nodding.turns_a_stop = static_cast<int>(whole(n, 1.0, 1000.0)); }},
               {"stop_every", kLength, nodding.stop_every_m},
               {"encoder", [&](const YamlValue& encoder) { read_encoder(encoder, nodding); }},
               {"lever", read_lever},
               {"sensor", read_sensor},
               {"encoder_faults", read_faults}});
  nodding.start_turns = start_rad / kTwoPi;
  value.require_none(validate(nodding));
  return nodding;
}

}  // namespace gdtslam
