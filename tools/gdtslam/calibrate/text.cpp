#include "calibrate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using calib::CalibratedParameter;
using calib::CalibrationResult;
using Json = nlohmann::ordered_json;

const CalibratedParameter* find(const CalibrationResult& result, const std::string& name) {
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

/// Format of a parameter: bars in centimetres as in the paper, angles in degrees.
struct Display {
  double factor = 1.0;
  std::string unit;
};

Display choose_display(const CalibratedParameter& parameter) {
  if (parameter.unit == "rad") return {deg_from_rad(1.0), "deg"};
  return calib::is_bar(parameter.name) ? Display{100.0, "cm"} : Display{1.0, "m"};
}

std::string sigma_text(double sigma) { return std::isfinite(sigma) ? fmt::format("{:.4f}", sigma) : "free"; }

std::string row(const CalibratedParameter& parameter, const Display& display) {
  const auto& [factor, unit] = display;
  return fmt::format("{:<18} {:>10.4f} {:>10.4f} {:>9} {:<3} {:>5.0f} %", parameter.name, factor * parameter.start,
                     factor * parameter.estimate, sigma_text(factor * parameter.sigma), unit,
                     100.0 * parameter.data_share);
}

std::string heading() {
  return fmt::format("\n\n{:<18} {:>10} {:>10} {:>9} {:<3} {:>7}\n", "", "start", "estimate", "sigma", "", "data");
}

std::string distrust_text(const std::string& distrust) {
  return "NOT TO BE TRUSTED, nor any sigma above: " + distrust + "\n";
}

std::string notes_text(const char* untold, const std::vector<calib::WeakCombination>& combinations,
                       const std::vector<std::string>& remarks) {
  std::string text;
  if (!combinations.empty()) text += std::string("\n") + untold + "\n";
  for (const calib::WeakCombination& weak : combinations) text += "  " + weak.text + "\n";
  if (!remarks.empty()) text += "\nRemarks:\n";
  for (const std::string& remark : remarks) text += "  " + remark + "\n";
  return text;
}

/// A delta of the paper, in metres; empty for a bar outside the loop.
struct Delta {
  std::string name;
  std::string place;
  std::optional<double> value_m;
  double sigma_m = 0.0;
};

// Deltas from the nominal lengths of the paper's linkage that the start is named after.
std::vector<Delta> compute_deltas(const CalibrateOutcome& outcome) {
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
  const std::vector<Delta> deltas = compute_deltas(outcome);
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
  if (!outcome.distrust.empty()) return text + distrust_text(outcome.distrust);
  return text + fmt::format(
                    "elevation known to {:.4f} deg (RMS over the sweep used), plus what the surfaces lean: 0.1 deg "
                    "for 0.1 deg\n",
                    deg_from_rad(result.elevation_sigma_rad));
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json parameters_json(const std::vector<CalibratedParameter>& parameters) {
  Json list = Json::array();
  for (const CalibratedParameter& parameter : parameters) {
    list.push_back({{"name", parameter.name},
                    {"unit", parameter.unit},
                    {"start", parameter.start},
                    {"estimate", parameter.estimate},
                    {"sigma", number(parameter.sigma)},
                    {"data_share", parameter.data_share},
                    {"at_bound", parameter.at_bound},
                    {"observable", parameter.observable}});
  }
  return list;
}

Json warnings_json(const std::vector<LogReader::Warning>& warnings) {
  Json list = Json::array();
  for (const LogReader::Warning& warning : warnings) {
    list.push_back({{"kind", warning.kind}, {"count", warning.count}, {"first", warning.first}});
  }
  return list;
}

Json deltas_json(const CalibrateOutcome& outcome) {
  Json list = Json::array();
  for (const Delta& delta : compute_deltas(outcome)) {
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
  std::string text = fmt::format("{}, {} of the crank, {} with a scatter of {:.1f} mm",
                                 plural(statistics.scans, "scan"), plural(statistics.stops, "place"),
                                 plural(statistics.ranges, "range"), 1000.0 * statistics.range_sigma_m) +
                     heading();
  for (const CalibratedParameter& parameter : outcome.result.parameters) {
    text += fmt::format("{}  {}{}\n", row(parameter, choose_display(parameter)),
                        parameter.observable ? "observed" : "not observed", parameter.at_bound ? ", on its bound" : "");
  }
  return text + deltas_text(outcome) + fit_text(outcome) +
         notes_text("What these ranges do not tell:", outcome.result.weak, outcome.result.remarks);
}

std::string as_text(const SelfCalibrateOutcome& outcome) {
  const calib::SelfCalibrationResult& result = outcome.result;
  std::string text = fmt::format("{}, {}, {} compared", plural(outcome.scans, "scan"),
                                 plural(outcome.strokes, "stroke"), plural(outcome.beams, "beam")) +
                     heading();
  for (const CalibratedParameter& parameter : result.parameters) {
    text += row(parameter, parameter.unit == "rad" ? choose_display(parameter) : Display{100.0, "cm"}) + "\n";
  }
  text += fmt::format(
      "\nstrokes miss each other by {:.1f} mm before, {:.1f} mm after (median of {} pairs); {} after {} rounds\n",
      1000.0 * result.median_miss_before_m, 1000.0 * result.median_miss_m, result.pairs,
      result.converged ? "converged" : "NOT CONVERGED", result.rounds);
  if (!outcome.distrust.empty()) text += distrust_text(outcome.distrust);
  return text + notes_text("What the strokes do not tell:", result.weak, result.remarks);
}

Json as_json(const CalibrateOutcome& outcome) {
  const CalibrationResult& result = outcome.result;
  const StopStatistics& statistics = outcome.statistics;
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
          {"parameters", parameters_json(result.parameters)},
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
          {"distrust", text_or_null(outcome.distrust)},
          {"remarks", result.remarks},
          {"warnings", warnings_json(outcome.warnings)}};
}

Json as_json(const SelfCalibrateOutcome& outcome) {
  const calib::SelfCalibrationResult& result = outcome.result;
  Json weak = Json::array();
  for (const calib::WeakCombination& combination : result.weak) weak.push_back(combination.text);
  return {{"start", outcome.start.name},
          {"scans", outcome.scans},
          {"strokes", outcome.strokes},
          {"beams", outcome.beams},
          {"pairs", result.pairs},
          {"parameters", parameters_json(result.parameters)},
          {"singular_values", result.singular_values},
          {"weak", weak},
          {"median_miss_before_m", result.median_miss_before_m},
          {"median_miss_m", result.median_miss_m},
          {"rounds", result.rounds},
          {"converged", result.converged},
          {"distrust", text_or_null(outcome.distrust)},
          {"remarks", result.remarks},
          {"warnings", warnings_json(outcome.warnings)}};
}

}  // namespace gdtslam
