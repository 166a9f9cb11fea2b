#include "text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using calib::CalibratedParameter;
using calib::CalibrationResult;
using Json = nlohmann::ordered_json;

bool is_bar(const std::string& name) {
  return name == "crank" || name == "coupler" || name == "rocker" || name == "ground";
}

const CalibratedParameter* find(const CalibrationResult& result, const std::string& name) {
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

/// How a parameter is shown: bars in centimetres as the paper has them, angles in degrees.
struct Display {
  double factor = 1.0;
  std::string unit;
};

Display display_of(const CalibratedParameter& parameter) {
  if (parameter.unit == "rad") return {deg_from_rad(1.0), "deg"};
  return is_bar(parameter.name) ? Display{100.0, "cm"} : Display{1.0, "m"};
}

std::string sigma_text(double sigma) { return std::isfinite(sigma) ? fmt::format("{:.4f}", sigma) : "free"; }

std::string row(const CalibratedParameter& parameter) {
  const auto [factor, unit] = display_of(parameter);
  return fmt::format("{:<18} {:>10.4f} {:>10.4f} {:>9} {:<3} {:>5.0f} %  {}{}\n", parameter.name,
                     factor * parameter.start, factor * parameter.estimate, sigma_text(factor * parameter.sigma), unit,
                     100.0 * parameter.data_share, parameter.observable ? "observed" : "not observed",
                     parameter.at_bound ? ", on its bound" : "");
}

/// A delta of the paper, in metres; nothing for a bar that is not in the loop.
struct Delta {
  std::string name;
  std::string place;
  std::optional<double> value_m;
  double sigma_m = 0.0;
};

// Relative to the nominal lengths of the reading that the start's name has.
std::vector<Delta> deltas_of(const CalibrateOutcome& outcome) {
  const std::string& name = outcome.start.name;
  std::vector<Delta> deltas;
  for (const calib::PaperBar& bar : calib::paper_bars(name)) {
    const calib::FourBar nominal = calib::linkage_preset(name.substr(0, std::string("paper-b").size())).bars;
    Delta delta{.name = bar.name, .place = bar.place, .value_m = std::nullopt};
    if (const CalibratedParameter* parameter = bar.place.empty() ? nullptr : find(outcome.result, bar.place)) {
      const double length_m = bar.place == "crank"     ? nominal.crank_m
                              : bar.place == "coupler" ? nominal.coupler_m
                              : bar.place == "rocker"  ? nominal.rocker_m
                                                       : nominal.ground_m;
      delta.value_m = parameter->estimate - length_m;
      delta.sigma_m = parameter->sigma;
    }
    deltas.push_back(std::move(delta));
  }
  return deltas;
}

std::string deltas_text(const CalibrateOutcome& outcome) {
  const std::vector<Delta> deltas = deltas_of(outcome);
  if (deltas.empty()) return "";
  std::string text = "\nThe paper's bars under the reading " + outcome.start.name + ":\n";
  for (const Delta& delta : deltas) {
    text += delta.value_m ? fmt::format("{:<8} {:>+8.4f} +- {} cm  ({})\n", delta.name, 100.0 * *delta.value_m,
                                        sigma_text(100.0 * delta.sigma_m), delta.place)
                          : fmt::format("{:<8} not in the loop: with the elevation offset\n", delta.name);
  }
  return text;
}

std::string fit_text(const CalibrateOutcome& outcome) {
  const CalibrationResult& result = outcome.result;
  std::string text = fmt::format(
      "\n{} of {} averages used, {} of them outliers; residual {:.2f} sigma without those, {:.2f} with; {} after "
      "{} iterations\n",
      result.observations, outcome.observations.size() + outcome.unassigned, result.outliers, result.residual_rms,
      result.all_rms, result.converged ? "converged" : "NOT CONVERGED", result.iterations);
  if (std::isfinite(result.other_assembly_rms)) {
    text +=
        fmt::format("assembly {}; the other one leaves {:.0f} sigma\n",
                    result.model.assembly == calib::Assembly::kOpen ? "open" : "crossed", result.other_assembly_rms);
  }
  if (!outcome.distrust.empty()) return text + "NOT TO BE TRUSTED, nor any sigma above: " + outcome.distrust + "\n";
  return text + fmt::format(
                    "elevation known to {:.4f} deg (RMS over the sweep used), plus what the surfaces lean: 0.1 deg "
                    "for 0.1 deg\n",
                    deg_from_rad(result.elevation_sigma_rad));
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json as_json(const CalibratedParameter& parameter) {
  return {{"name", parameter.name},           {"unit", parameter.unit},
          {"start", parameter.start},         {"estimate", parameter.estimate},
          {"sigma", number(parameter.sigma)}, {"data_share", parameter.data_share},
          {"at_bound", parameter.at_bound},   {"observable", parameter.observable}};
}

Json deltas_json(const CalibrateOutcome& outcome) {
  Json list = Json::array();
  for (const Delta& delta : deltas_of(outcome)) {
    list.push_back({{"name", delta.name},
                    {"in_loop", delta.value_m.has_value()},
                    {"place", delta.value_m ? delta.place : "elevation offset"},
                    {"value_m", delta.value_m ? Json(*delta.value_m) : Json()},
                    {"sigma_m", delta.value_m ? number(delta.sigma_m) : Json()}});
  }
  return list;
}

Json observability_json(const CalibrationResult& result) {
  Json weak = Json::array();
  for (const calib::WeakCombination& combination : result.weak) {
    weak.push_back(
        {{"singular_value", combination.singular_value}, {"weights", combination.weights}, {"text", combination.text}});
  }
  return {{"singular_values", result.singular_values}, {"weak", weak}};
}

}  // namespace

std::string as_text(const CalibrateOutcome& outcome) {
  const StopStatistics& statistics = outcome.statistics;
  std::string text = fmt::format(
      "{} scans, {} places of the crank, {} ranges with a scatter of {:.1f} mm\n\n"
      "{:<18} {:>10} {:>10} {:>9} {:<3} {:>7}\n",
      statistics.scans, statistics.stops, statistics.ranges, 1000.0 * statistics.range_sigma_m, "", "start", "estimate",
      "sigma", "", "data");
  for (const CalibratedParameter& parameter : outcome.result.parameters) text += row(parameter);
  text += deltas_text(outcome) + fit_text(outcome);
  if (!outcome.result.weak.empty()) text += "\nWhat these ranges do not tell:\n";
  for (const calib::WeakCombination& weak : outcome.result.weak) text += "  " + weak.text + "\n";
  if (!outcome.result.remarks.empty()) text += "\nRemarks:\n";
  for (const std::string& remark : outcome.result.remarks) text += "  " + remark + "\n";
  return text;
}

Json as_json(const CalibrateOutcome& outcome) {
  const CalibrationResult& result = outcome.result;
  const StopStatistics& statistics = outcome.statistics;
  Json parameters = Json::array();
  for (const CalibratedParameter& parameter : result.parameters) parameters.push_back(as_json(parameter));
  Json warnings = Json::array();
  for (const LogReader::Warning& warning : outcome.warnings) {
    warnings.push_back({{"kind", warning.kind}, {"count", warning.count}, {"first", warning.first}});
  }
  return {{"start", outcome.start.name},
          {"assembly", result.model.assembly == calib::Assembly::kOpen ? "open" : "crossed"},
          {"scans", statistics.scans},
          {"uncovered_scans", statistics.uncovered},
          {"ranges", statistics.ranges},
          {"places", statistics.stops},
          {"range_sigma_m", statistics.range_sigma_m},
          {"unassigned", outcome.unassigned},
          {"observations", result.observations},
          {"outliers", result.outliers},
          {"parameters", parameters},
          {"paper_bars", deltas_json(outcome)},
          {"covariance", result.covariance},
          {"observability", observability_json(result)},
          {"residual_rms", number(result.residual_rms)},
          {"all_rms", number(result.all_rms)},
          {"other_assembly_rms", number(result.other_assembly_rms)},
          {"elevation_sigma_rad", number(result.elevation_sigma_rad)},
          {"iterations", result.iterations},
          {"converged", result.converged},
          {"reason", result.reason},
          {"distrust", outcome.distrust.empty() ? Json() : Json(outcome.distrust)},
          {"remarks", result.remarks},
          {"warnings", warnings}};
}

std::vector<ParameterSigma> uncertainty_of(const CalibrationResult& result) {
  std::vector<ParameterSigma> list;
  for (const CalibratedParameter& parameter : result.parameters) {
    if (std::isfinite(parameter.sigma)) list.push_back({parameter.name, parameter.sigma});
  }
  return list;
}

}  // namespace gdtslam
