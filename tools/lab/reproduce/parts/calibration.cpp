// Figure A: the linkage calibrated before a wall. The simulated mount has the lengths that the paper found, the
// calibration starts from the nominal ones, so that it has to find what the paper did.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "engine/runs/linkage/linkage_file.hpp"
#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "tools/gdtslam/calibrations/run.hpp"
#include "tools/lab/reproduce/drives.hpp"
#include "tools/lab/reproduce/part.hpp"

namespace gdtslam::reproduce {
namespace {

constexpr const char* kNominal = "paper-b";
constexpr const char* kTruth = "paper-b-calibrated";
// A placed average of 250 ranges of the paper's protocol; its own curve is read off figure A by eye.
constexpr std::array<double, 7> kPaper_cm{0.4034, -0.1178, -0.3218, 0.2625, -0.09, 0.07, -0.1709};

double length_m(const calib::FourBar& bars, const std::string& place) {
  return place == "crank"     ? bars.crank_m
         : place == "coupler" ? bars.coupler_m
         : place == "rocker"  ? bars.rocker_m
                              : bars.ground_m;
}

const calib::CalibratedParameter* parameter_of(const calib::CalibrationResult& result, const std::string& name) {
  for (const calib::CalibratedParameter& parameter : result.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

Table deltas_table(const CalibrateOutcome& outcome) {
  Table table{
      "Corrections of the seven lengths, cm. The simulated mount has the paper\u2019s, so they are the truth here.",
      {"length", "bar", "paper = truth", "found", "sigma", "told by the ranges"},
      {}};
  const calib::FourBar nominal = calib::linkage_preset(kNominal).bars;
  const std::vector<calib::PaperBar> bars = calib::paper_bars(kNominal);
  for (std::size_t k = 0; k < bars.size() && k < kPaper_cm.size(); ++k) {
    const calib::CalibratedParameter* const found =
        bars[k].place.empty() ? nullptr : parameter_of(outcome.result, bars[k].place);
    std::vector<std::string> row{fmt::format("L{}", k + 1), bars[k].place.empty() ? "not in the loop" : bars[k].place,
                                 fmt::format("{:+.4f}", kPaper_cm[k])};
    if (found == nullptr) {
      row.insert(row.end(), {"in the elevation offset", "", ""});
    } else {
      row.insert(row.end(), {fmt::format("{:+.4f}", 100.0 * (found->estimate - length_m(nominal, bars[k].place))),
                             std::isfinite(found->sigma) ? fmt::format("{:.4f}", 100.0 * found->sigma) : "free",
                             fmt::format("{:.0f} %", 100.0 * found->data_share)});
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Root mean square over the crank's turn of what a model's elevation is off, where the true one is within the range
/// that the calibration used.
double elevation_error_deg(const calib::SweepModel& model, const calib::SweepModel& truth, double most_rad) {
  double sum = 0.0;
  int count = 0;
  for (std::int64_t ticks = 0; ticks < truth.encoder.ticks_per_turn; ticks += 20) {
    const auto truly = calib::elevation_rad(truth, calib::crank_rad(truth.encoder, static_cast<double>(ticks)));
    const auto found = calib::elevation_rad(model, calib::crank_rad(model.encoder, static_cast<double>(ticks)));
    if (!truly || *truly > most_rad) continue;
    if (!found) return std::numeric_limits<double>::infinity();
    const double off_deg = deg_from_rad(*found - *truly);
    sum += off_deg * off_deg;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : std::numeric_limits<double>::infinity();
}

// Root mean square of the misses, the wall at the distance that the model has for it.
double miss_rms_m(const CalibrateOutcome& outcome, const calib::SweepModel& model, double distance_m) {
  double sum = 0.0;
  int count = 0;
  for (const calib::RangeObservation& range : outcome.observations) {
    const auto elevation = calib::elevation_rad(model, calib::crank_rad(model.encoder, range.ticks));
    if (!elevation || *elevation > outcome.max_elevation_rad) continue;
    const double miss_m = range.range_m * std::cos(*elevation) - distance_m;
    sum += miss_m * miss_m;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

void add_rows(Part& part, const CalibrateOutcome& outcome, const calib::SweepModel& truth) {
  const double before_m = miss_rms_m(outcome, outcome.start, outcome.start_surfaces.front().distance_m);
  const double after_m = miss_rms_m(outcome, outcome.result.model, outcome.result.surfaces.front().distance_m);
  part.state("wall\u2019s distance by the ranges, scatter before", "curves differ (figure A(a))",
             length_with_unit(before_m) + " rms",
             "with the nominal lengths, up to 60\u00b0; the paper shows curves only");
  part.claim("the same after the calibration", "best fit (figure A(b))", length_with_unit(after_m) + " rms",
             after_m < 0.5 * before_m, "rule: at most half of before; what is left is the noise of the averages");
  const double off_before = elevation_error_deg(outcome.start, truth, outcome.max_elevation_rad);
  const double off_after = elevation_error_deg(outcome.result.model, truth, outcome.max_elevation_rad);
  part.claim("elevation, off the truth", "",
             fmt::format("{:.3f}\u00b0 before, {:.3f}\u00b0 after", off_before, off_after),
             off_after < 0.1 * off_before,
             fmt::format("rms up to 60\u00b0; the calibration itself states {:.3f}\u00b0; rule: a tenth of before",
                         deg_from_rad(outcome.result.elevation_sigma_rad)));
}

// Remarks of the calibration are half sentences, for a terminal.
std::string sentence(std::string text) {
  if (text.empty()) return text;
  if (text.front() >= 'a' && text.front() <= 'z') text.front() = static_cast<char>(text.front() - 'a' + 'A');
  return text.back() == '.' ? text : text + ".";
}

}  // namespace

Part make_calibration(const PartContext& place) {
  const Drive drive = place.drives.drive("wall");
  CalibrateJob job;
  job.logs = {drive.log};
  job.start = resolve_linkage(kNominal);
  const CalibrateOutcome outcome = run_calibration(
      job, [&](double share) { place.progress(0.9 * share); }, place.stop);
  Part part;
  part.source =
      "The scene wall, seed 1, with the paper\u2019s protocol: the crank stops each 1.8\u00b0 for 250 scans. The mount "
      "has the lengths that the paper found; the calibration starts from the nominal ones.";
  add_picture(part, place, calibration_figure(outcome),
              {"ranges.svg",
               "Ranges to the wall over the encoder and what is left of them over the elevation, before and after."});
  part.tables.push_back(deltas_table(outcome));
  add_rows(part, outcome, read_linkage(drive.truth.substr(0, drive.truth.rfind(".truth.tum")) + ".linkage.yaml"));
  part.notes.push_back(
      "The lengths need not be found, the elevation is what counts. (A1) as printed, R_m(0) cos \u03b8, is neither the "
      "range nor the distance over the floor; what is fitted is r cos \u03b8 = d.");
  for (const std::string& remark : outcome.result.remarks) part.notes.push_back(sentence(remark));
  part.by_hand = Drives::commands_of("wall");
  part.by_hand.push_back("gdtslam calibrate wall.log -o found.yaml --start paper-b --picture ranges.svg");
  return part;
}

}  // namespace gdtslam::reproduce
