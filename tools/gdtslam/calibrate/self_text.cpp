#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "gdtslam/core/angle.hpp"
#include "tools/gdtslam/calibrations/self_run.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

std::string row(const calib::CalibratedParameter& parameter) {
  const bool is_angle = parameter.unit == "rad";
  const double factor = is_angle ? deg_from_rad(1.0) : 100.0;
  return fmt::format("{:<18} {:>10.4f} {:>10.4f} {:>9} {:<3} {:>5.0f} %\n", parameter.name, factor * parameter.start,
                     factor * parameter.estimate,
                     std::isfinite(parameter.sigma) ? fmt::format("{:.4f}", factor * parameter.sigma) : "free",
                     is_angle ? "deg" : "cm", 100.0 * parameter.data_share);
}

}  // namespace

std::string as_text(const SelfCalibrateOutcome& outcome) {
  const calib::SelfCalibrationResult& result = outcome.result;
  std::string text =
      fmt::format("{} scans, {} strokes, {} beams compared\n\n{:<18} {:>10} {:>10} {:>9} {:<3} {:>7}\n", outcome.scans,
                  outcome.strokes, outcome.beams, "", "start", "estimate", "sigma", "", "data");
  for (const calib::CalibratedParameter& parameter : result.parameters) text += row(parameter);
  text += fmt::format(
      "\nstrokes miss each other by {:.1f} mm before, {:.1f} mm after (median of {} pairs); {} after {} rounds\n",
      1000.0 * result.median_miss_before_m, 1000.0 * result.median_miss_m, result.pairs,
      result.converged ? "converged" : "NOT CONVERGED", result.rounds);
  if (!outcome.distrust.empty()) text += "NOT TO BE TRUSTED, nor any sigma above: " + outcome.distrust + "\n";
  if (!result.weak.empty()) text += "\nWhat the strokes do not tell:\n";
  for (const calib::WeakCombination& weak : result.weak) text += "  " + weak.text + "\n";
  if (!result.remarks.empty()) text += "\nRemarks:\n";
  for (const std::string& remark : result.remarks) text += "  " + remark + "\n";
  return text;
}

Json as_json(const SelfCalibrateOutcome& outcome) {
  const calib::SelfCalibrationResult& result = outcome.result;
  Json parameters = Json::array();
  for (const calib::CalibratedParameter& parameter : result.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"start", parameter.start},
                          {"estimate", parameter.estimate},
                          {"sigma", std::isfinite(parameter.sigma) ? Json(parameter.sigma) : Json()},
                          {"data_share", parameter.data_share},
                          {"at_bound", parameter.at_bound},
                          {"observable", parameter.observable}});
  }
  Json warnings = Json::array();
  for (const LogReader::Warning& warning : outcome.warnings) {
    warnings.push_back({{"kind", warning.kind}, {"count", warning.count}, {"first", warning.first}});
  }
  Json weak = Json::array();
  for (const calib::WeakCombination& combination : result.weak) weak.push_back(combination.text);
  return {{"start", outcome.start.name},
          {"scans", outcome.scans},
          {"strokes", outcome.strokes},
          {"beams", outcome.beams},
          {"pairs", result.pairs},
          {"parameters", parameters},
          {"singular_values", result.singular_values},
          {"weak", weak},
          {"median_miss_before_m", result.median_miss_before_m},
          {"median_miss_m", result.median_miss_m},
          {"rounds", result.rounds},
          {"converged", result.converged},
          {"distrust", outcome.distrust.empty() ? Json() : Json(outcome.distrust)},
          {"remarks", result.remarks},
          {"warnings", warnings}};
}

std::vector<ParameterSigma> uncertainty_of(const calib::SelfCalibrationResult& result) {
  std::vector<ParameterSigma> list;
  for (const calib::CalibratedParameter& parameter : result.parameters) {
    if (std::isfinite(parameter.sigma)) list.push_back({parameter.name, parameter.sigma});
  }
  return list;
}

}  // namespace gdtslam
