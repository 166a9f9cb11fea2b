// The linkages of the paper: its lengths under three readings of its figure, nominal and as calibrated.
#include <algorithm>
#include <array>

#include "gdtslam/calib/calibration.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam::calib {
namespace {

/// L1..L7 and delta1..delta7 of the paper's appendix in micrometres, so that every length is the double nearest to it.
constexpr std::array<int, 7> kNominal_um = {132000, 36000, 125000, 85000, 88000, 50000, 118000};
constexpr std::array<int, 7> kDelta_um = {4034, -1178, -3218, 2625, -900, 700, -1709};
constexpr double kMicrometres = 1e6;

/// Assignment of L1..L7 to the bars.
struct Reading {
  std::size_t crank;
  std::size_t coupler;
  std::size_t rocker;
  std::size_t ground;
};
/// A, B and C.
constexpr std::array<Reading, 3> kReadings{{{2, 4, 5, 3}, {2, 4, 5, 6}, {2, 4, 6, 5}}};

FourBar read_bars(const Reading& reading, bool is_calibrated) {
  const auto length_m = [&](std::size_t number) {
    return (kNominal_um.at(number - 1) + (is_calibrated ? kDelta_um.at(number - 1) : 0)) / kMicrometres;
  };
  return {.crank_m = length_m(reading.crank),
          .coupler_m = length_m(reading.coupler),
          .rocker_m = length_m(reading.rocker),
          .ground_m = length_m(reading.ground)};
}

}  // namespace

const std::vector<LinkagePreset>& linkage_presets() {
  static const std::vector<LinkagePreset> presets = {
      {"paper-a", "reading A: bars L2, L4, L5, L3; an even sweep of 49 deg", read_bars(kReadings[0], false)},
      {"paper-a-calibrated", "reading A with the paper's calibrated lengths", read_bars(kReadings[0], true)},
      {"paper-b", "reading B, which fits the paper best: bars L2, L4, L5, L6; slow lift by 93 deg, quick return",
       read_bars(kReadings[1], false)},
      {"paper-b-calibrated", "reading B with the paper's calibrated lengths", read_bars(kReadings[1], true)},
      {"paper-c", "reading C: bars L2, L4, L6, L5; an even sweep of 93 deg", read_bars(kReadings[2], false)},
      {"paper-c-calibrated", "reading C with the paper's calibrated lengths", read_bars(kReadings[2], true)}};
  return presets;
}

const LinkagePreset& linkage_preset(std::string_view name) {
  std::string known;
  for (const LinkagePreset& preset : linkage_presets()) {
    if (preset.name == name) {
      return preset;
    }
    known += (known.empty() ? "" : ", ") + std::string(preset.name);
  }
  throw ConfigError("no linkage is named '" + std::string(name) + "'; the presets are " + known);
}

std::vector<PaperBar> paper_bars(const std::string& model_name) {
  const std::vector<LinkagePreset>& presets = linkage_presets();
  const auto preset = std::find_if(presets.begin(), presets.end(),
                                   [&](const LinkagePreset& known) { return known.name == model_name; });
  if (preset == presets.end()) return {};
  constexpr std::size_t kPresetsOfReading = 2;  // one as drawn and one calibrated
  const std::size_t number = static_cast<std::size_t>(preset - presets.begin()) / kPresetsOfReading;
  std::vector<PaperBar> bars(kNominal_um.size());
  for (std::size_t k = 0; k < bars.size(); ++k) bars[k].name = "delta" + std::to_string(k + 1);
  const Reading& reading = kReadings.at(number);
  bars[reading.crank - 1].place = "crank";
  bars[reading.coupler - 1].place = "coupler";
  bars[reading.rocker - 1].place = "rocker";
  bars[reading.ground - 1].place = "ground";
  return bars;
}

}  // namespace gdtslam::calib
