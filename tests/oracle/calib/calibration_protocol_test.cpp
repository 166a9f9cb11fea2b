// The paper's protocol against theory: a separate Monte Carlo gives an elevation error of 0.012 degrees (RMS over the
// sweep up to 60 degrees) with the lever arm known, and 0.084 degrees with it free. GDTSLAM_CALIBRATION_DRAWS sets how
// many mounts are drawn; docs/calibration.md states the figures of 200.
#include "calibration_protocol.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <string>

#include "calib/calibration/calibration_residual.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam::calib {
namespace {

constexpr double kUpTo_rad = 60.0 * kPi / 180.0;

int draws(int quick) {
  const char* text = std::getenv("GDTSLAM_CALIBRATION_DRAWS");
  return text != nullptr ? std::max(1, std::atoi(text)) : quick;
}

/// What a series of experiments gives.
struct Series {
  double rms_deg = 0.0;
  double worst_deg = 0.0;
  int not_converged = 0;
  int wrong_assembly = 0;
  int unflagged = 0;       ///< experiments in which a bar passes for observable, or the scale is not named
  double sigma_deg = 0.0;  ///< RMS of what the calibration reports
};

bool flags_what_one_wall_cannot_tell(const CalibrationResult& result) {
  for (const CalibratedParameter& parameter : result.parameters) {
    const bool is_bar = parameter.name == "crank" || parameter.name == "coupler" || parameter.name == "rocker" ||
                        parameter.name == "ground";
    if (is_bar && parameter.observable) return false;
  }
  bool names_scale = false;
  for (const WeakCombination& weak : result.weak) names_scale |= weak.text.find("(scale)") != std::string::npos;
  bool names_wall = false;
  for (const std::string& remark : result.remarks) names_wall |= remark.find("one wall") != std::string::npos;
  return names_scale && names_wall;
}

Series run(const Protocol& protocol, const CalibrationOptions& options, int count, std::uint64_t seed) {
  Random random(seed);
  Series series;
  double sum = 0.0;
  double sum_of_sigmas = 0.0;
  for (int k = 0; k < count; ++k) {
    const Experiment experiment = draw_experiment(protocol, random);
    const CalibrationResult result = calibrate(experiment.start, experiment.surfaces, experiment.observations, options);
    const double error_deg = deg_from_rad(elevation_error_rad(experiment.truth, result.model, kUpTo_rad));
    sum += error_deg * error_deg;
    sum_of_sigmas += result.elevation_sigma_rad * result.elevation_sigma_rad;
    series.worst_deg = std::max(series.worst_deg, error_deg);
    series.not_converged += result.converged ? 0 : 1;
    series.wrong_assembly += result.model.assembly == experiment.truth.assembly ? 0 : 1;
    series.unflagged += flags_what_one_wall_cannot_tell(result) ? 0 : 1;
  }
  series.rms_deg = std::sqrt(sum / count);
  series.sigma_deg = deg_from_rad(std::sqrt(sum_of_sigmas / count));
  std::printf("%d draws: elevation error RMS %.4f deg, worst %.4f, reported %.4f\n", count, series.rms_deg,
              series.worst_deg, series.sigma_deg);
  return series;
}

double prior_of(const std::string& name) {
  const CalibrationOptions defaults;
  if (name == "zero") return defaults.zero_prior_rad;
  if (name == "offset") return defaults.offset_prior_rad;
  if (name.starts_with("lever")) return defaults.lever_prior_m;
  return name.starts_with("distance") ? defaults.distance_prior_m : defaults.bar_prior_m;
}

double derivative_by(const std::string& name, const SurfaceMiss& miss) {
  if (name == "crank") return miss.by_elevation * miss.elevation_by_crank;
  if (name == "coupler") return miss.by_elevation * miss.elevation_by_coupler;
  if (name == "rocker") return miss.by_elevation * miss.elevation_by_rocker;
  if (name == "ground") return miss.by_elevation * miss.elevation_by_ground;
  if (name == "zero") return miss.by_elevation * miss.elevation_by_zero;
  if (name == "offset") return miss.by_elevation;
  if (name == "lever.forward") return miss.by_lever_forward;
  return name == "lever.up" ? miss.by_lever_up : miss.by_distance;
}

/// The error of each combination in reported standard deviations, see below.
std::vector<double> pulls_of(const Experiment& experiment, const CalibrationResult& result,
                             const CalibrationOptions& options) {
  const std::size_t count = result.parameters.size();
  CalibrationSurface true_wall = result.surfaces.front();
  true_wall.distance_m = experiment.wall_m;
  std::vector<double> pulls(count, 0.0);
  for (const RangeObservation& seen : experiment.observations) {
    const SurfaceMiss found = *surface_miss(result.model, result.surfaces.front(), seen);
    const double elevation =
        measured_elevation_rad(result.model.mount, result.surfaces.front(), seen, found.elevation_rad);
    if (std::fabs(elevation) > options.max_elevation_rad) continue;
    const double gain = 1.0 / (seen.sigma_m * std::cos(elevation));
    const double error = gain * (found.miss_m - surface_miss(experiment.truth, true_wall, seen)->miss_m);
    for (std::size_t c = 0; c < count; ++c) {
      double along = 0.0;  // U_c of this observation, times the singular value
      for (std::size_t i = 0; i < count; ++i) {
        const std::string& name = result.parameters[i].name;
        along += gain * derivative_by(name, found) * prior_of(name) * result.combinations[c * count + i];
      }
      pulls[c] += along / result.singular_values[c] * error;
    }
  }
  return pulls;
}

TEST(CalibrationProtocol, LeverKnown) {
  const Series series = run({}, {}, draws(30), 1);
  EXPECT_LE(series.rms_deg, 0.03);
  EXPECT_GE(series.rms_deg, 0.006) << "half of what theory says can be reached: the check itself must be wrong";
  EXPECT_NEAR(series.sigma_deg / series.rms_deg, 1.0, 0.3);
  EXPECT_EQ(series.not_converged, 0);
  EXPECT_EQ(series.wrong_assembly, 0);
  EXPECT_EQ(series.unflagged, 0);
}

TEST(CalibrationProtocol, LeverFree) {
  const Series series = run({.lever_error_m = 0.02}, {.free_lever = true}, draws(30), 2);
  EXPECT_LE(series.rms_deg, 0.15);
  EXPECT_GE(series.rms_deg, 0.04);
  EXPECT_NEAR(series.sigma_deg / series.rms_deg, 1.0, 0.3);
  EXPECT_EQ(series.not_converged, 0);
  EXPECT_EQ(series.wrong_assembly, 0);
  EXPECT_EQ(series.unflagged, 0);
}

// The other readings of the figure; docs/calibration.md has 0.011 degrees for A over its 49 degrees.
TEST(CalibrationProtocol, OtherReadings) {
  for (const char* preset : {"paper-a", "paper-c"}) {
    const Series series = run({.preset = preset}, {}, draws(10), 3);
    EXPECT_LE(series.rms_deg, 0.03) << preset;
    EXPECT_EQ(series.not_converged, 0) << preset;
    EXPECT_EQ(series.wrong_assembly, 0) << preset;
  }
}

// Without priors a combination's error over its reported standard deviation must scatter by 1. Along what the data do
// not tell the solution may lie far from the truth, and the tight combinations bend on the way, so the error is taken
// where the combination lives: in the misses, by U_k' (miss(estimate) - miss(truth)), which for small errors is the
// singular value times the combination.
TEST(CalibrationProtocol, ReportedDeviationsAreTheEmpiricalOnes) {
  struct Case {
    bool free_lever;
    std::size_t combinations;  ///< that every draw observes
  };
  for (const Case& scene : {Case{false, 6}, Case{true, 6}}) {
    const Protocol protocol{.lever_error_m = scene.free_lever ? 0.02 : 0.0};
    CalibrationOptions options = CalibrationOptions{.free_lever = scene.free_lever}.without_priors();
    options.try_both_assemblies = false;
    options.bar_bound_m = 0.02;  // the box of (A2) would be a prior too
    const int count = draws(60);
    Random random(4);
    std::map<std::size_t, double> sq_pulls;
    int unflagged = 0;
    for (int k = 0; k < count; ++k) {
      const Experiment experiment = draw_experiment(protocol, random);
      const CalibrationResult result =
          calibrate(experiment.start, experiment.surfaces, experiment.observations, options);
      unflagged += flags_what_one_wall_cannot_tell(result) ? 0 : 1;
      const std::vector<double> pulls = pulls_of(experiment, result, options);
      ASSERT_GE(pulls.size(), scene.combinations);
      for (std::size_t c = 0; c < scene.combinations; ++c) sq_pulls[c] += pulls[c] * pulls[c];
    }
    EXPECT_EQ(unflagged, 0) << "of " << count << ", lever " << (scene.free_lever ? "free" : "known");
    for (const auto& [combination, sum] : sq_pulls) {
      const double ratio = std::sqrt(sum / count);  // empirical over reported
      std::printf("lever %s, combination %zu: empirical over reported %.2f\n", scene.free_lever ? "free" : "known",
                  combination, ratio);
      EXPECT_GT(ratio, 0.7) << combination;
      EXPECT_LT(ratio, 1.3) << combination;
    }
  }
}

}  // namespace
}  // namespace gdtslam::calib
