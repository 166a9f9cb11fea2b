#include "run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/elementary.hpp"
#include "engine/mapping/match/motion_estimate.hpp"
#include "engine/runs/drive/stopwatch.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

// A method's reach is a little longer than the start's true error, as a careful user would choose.
constexpr double kReachFactor = 1.25;

struct Start {
  CellPose pose;
  StartReach reach;
  std::uint32_t level = 0;
  std::uint32_t number = 0;
};

/// A trial before the global solution is final.
struct End {
  Start start;
  std::uint32_t method = 0;
  LocalMinimum found;
  double seconds = 0.0;
};

StartReach widest_reach(const CompareJob& job) {
  StartReach reach = reach_of_prediction(job.mapper);
  for (const StartLevel& level : job.levels) {
    reach.half_m = std::max(reach.half_m, kReachFactor * level.distance_m);
    reach.half_rad = std::max(reach.half_rad, kReachFactor * level.angle_rad);
  }
  return reach;
}

std::vector<Start> make_starts(const CompareJob& job, const CellPose& predicted, const CellPose& solution,
                               std::uint64_t scan) {
  const StartReach least = reach_of_prediction(job.mapper);
  std::vector<Start> starts{{predicted, least, 0, 0}};
  const Random of_scan = Random(job.seed).split(scan);
  for (std::uint32_t level = 0; level < job.levels.size(); ++level) {
    Random random = of_scan.split(level);
    const StartLevel& off = job.levels[level];
    for (std::uint32_t number = 0; number < job.starts; ++number) {
      const auto [sin, cos] = sin_cos(random.uniform(-kPi, kPi));
      const double length = off.distance_m / job.mapper.map.resolution_m;
      const double turn = random.uniform() < 0.5 ? -off.angle_rad : off.angle_rad;
      const CellPose pose{solution.x + static_cast<float>(length * cos), solution.y + static_cast<float>(length * sin),
                          solution.theta + static_cast<float>(turn)};
      const StartReach reach{std::max(least.half_m, kReachFactor * off.distance_m),
                             std::max(least.half_rad, kReachFactor * off.angle_rad)};
      starts.push_back({pose, reach, level + 1, number});
    }
  }
  return starts;
}

class Comparison {
 public:
  Comparison(const CompareJob& job, Backend& backend, std::uint64_t every)
      : job_(job),
        isa_(backend.host_isa()),
        mapper_(job.mapper, backend, {.fall_back = false, .cpu = {}, .warn = {}}),
        motion_(job.mapper.odometry) {
    outcome_.every = every;
  }

  CompareOutcome run(ScanStream& scans, const CompareProgress& progress, const std::function<bool()>& stop) {
    for (std::optional<ScanRecord> record = scans.next(); record; record = scans.next()) {
      if (stop()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
      const Pose2 predicted = motion_.predict(record->T_odom_base).T_map_base;
      // The first scan makes the map, so it cannot be matched.
      const bool is_chosen = outcome_.scans_read % outcome_.every == outcome_.every / 2 && outcome_.scans_read > 0;
      const std::size_t trials = outcome_.trials.size();
      const bool is_measured = is_chosen && measure(*record, predicted);
      outcome_.too_few += is_chosen && !is_measured ? 1 : 0;
      const MatchResult match = mapper_.process(record->scan, record->T_odom_base);
      motion_.correct(match.T_map_base, match.accepted);
      if (is_measured && !match.accepted) {
        outcome_.scans.pop_back();
        outcome_.trials.resize(trials);
        ++outcome_.refused;
      }
      ++outcome_.scans_read;
      progress(outcome_.scans_read, scans.progress());
    }
    return std::move(outcome_);
  }

 private:
  // Equation (8) with the widest threshold: points that are predicted over unknown cells do not constrain the pose. The
  // same points for all methods and starts.
  bool choose_points(const ScanRecord& record, const Pose2& predicted, Objective& objective) {
    const std::vector<PointCells> all =
        in_cells(to_points(record.scan, job_.mapper.scan), job_.mapper.map.resolution_m);
    objective.set_anchor(map_cell_at(predicted.translation(), job_.mapper.map.resolution_m));
    objective.set_cap(mapper_.field().cap());
    values_.resize(all.size());
    objective.residuals(objective.to_cells(predicted), all, values_);
    points_.clear();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (values_[i] < mapper_.field().cap()) points_.push_back(all[i]);
    }
    const std::size_t every = (points_.size() + kMostCertifiedPoints - 1) / kMostCertifiedPoints;
    if (every > 1) {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < points_.size(); i += every) points_[kept++] = points_[i];
      points_.resize(kept);
    }
    objective.set_points(points_);
    return points_.size() >= static_cast<std::size_t>(job_.mapper.scan.min_points);
  }

  bool measure(const ScanRecord& record, const Pose2& predicted) {
    const GlobalField& mapped = mapper_.field();  // the field of this scan; with local.stretch it changes later
    Objective objective(mapped, Interpolation::kBilinear, CostForm::kDistance);
    if (!choose_points(record, predicted, objective)) return false;
    const FieldCopy field(mapped);
    const CertifiedMap map(field.view(), isa_);
    const CompareProblem problem{objective, map, job_.mapper};
    const CellPose from = objective.to_cells(predicted);
    GlobalSolution global = global_solution(problem, from, widest_reach(job_), job_.global);
    const std::vector<End> ends = run_methods(problem, make_starts(job_, from, global.pose, outcome_.scans_read));
    settle(objective, global, ends);
    note(record, objective, global, ends);
    return true;
  }

  static End run_method(MatcherKind method, const CompareProblem& problem, const Start& start) {
    End end;
    end.start = start;
    double wall_s = 0.0;
    Stopwatch watch;
    end.found = minimise_by(method, problem, start.pose, start.reach);
    watch.add_to(wall_s, end.seconds);
    end.found.cost = problem.objective.evaluate(end.found.pose);
    return end;
  }

  std::vector<End> run_methods(const CompareProblem& problem, const std::vector<Start>& starts) {
    std::vector<End> ends;
    for (const Start& start : starts) {
      // A first run is not measured, else the fastest method would pay for loading field, points, code and clock into
      // caches.
      run_method(MatcherKind::kGaussNewton, problem, start);
      for (std::uint32_t method = 0; method < job_.methods.size(); ++method) {
        End end = run_method(job_.methods[method], problem, start);
        end.method = method;
        ends.push_back(end);
      }
    }
    return ends;
  }

  // A method may have ended below the solution, by less than the gap if that is proven. The best known pose is then the
  // solution.
  static void settle(Objective& objective, GlobalSolution& global, const std::vector<End>& ends) {
    const auto best = std::min_element(ends.begin(), ends.end(),
                                       [](const End& a, const End& b) { return a.found.cost < b.found.cost; });
    if (best == ends.end() || best->found.cost >= global.cost ||
        !global.window.holds(objective.to_metres(best->found.pose))) {
      return;
    }
    const LocalMinimum end = polished(objective, best->found.pose);
    global.pose = end.pose;
    global.cost = end.cost;
    global.bound = std::min(global.bound, end.cost);
  }

  CompareTrial make_trial(const Objective& objective, const End& end, const GlobalSolution& global) const {
    const Pose2 solution = objective.to_metres(global.pose);
    const Pose2 from = objective.to_metres(end.start.pose);
    const Pose2 to = objective.to_metres(end.found.pose);
    const std::uint32_t excess = end.found.cost - std::min(global.bound, end.found.cost);
    const double resolution_m = job_.mapper.map.resolution_m;
    CompareTrial trial;
    trial.scan = static_cast<std::uint32_t>(outcome_.scans.size() - 1);
    trial.method = end.method;
    trial.level = end.start.level;
    trial.start = end.start.number;
    trial.start_m = (from.translation() - solution.translation()).norm();
    trial.start_rad = std::fabs(wrap_angle(from.theta_rad - solution.theta_rad));
    trial.x_m = std::fabs(to.x_m - solution.x_m);
    trial.y_m = std::fabs(to.y_m - solution.y_m);
    trial.theta_rad = std::fabs(wrap_angle(to.theta_rad - solution.theta_rad));
    trial.distance_m = (to.translation() - solution.translation()).norm();
    trial.excess_m = mean_cost_m(excess, points_.size(), resolution_m);
    trial.is_optimal = global.is_certified && excess <= cost_from_mean(job_.global.gap_m, points_.size(), resolution_m);
    trial.evaluations = end.found.evaluations;
    trial.seconds = end.seconds;
    return trial;
  }

  void note(const ScanRecord& record, const Objective& objective, const GlobalSolution& global,
            const std::vector<End>& ends) {
    const double resolution_m = job_.mapper.map.resolution_m;
    CompareScan scan;
    scan.index = outcome_.scans_read;
    scan.stamp_s = record.scan.stamp_s;
    scan.points = static_cast<std::uint32_t>(points_.size());
    scan.T_map_base = objective.to_metres(global.pose);
    scan.mean_cost_m = mean_cost_m(global.cost, points_.size(), resolution_m);
    scan.mean_bound_m = mean_cost_m(global.bound, points_.size(), resolution_m);
    scan.is_certified = global.is_certified;
    scan.hold = constraint_strength(line_information(points_, resolution_m));
    scan.seconds = global.seconds;
    outcome_.scans.push_back(scan);
    for (const End& end : ends) outcome_.trials.push_back(make_trial(objective, end, global));
  }

  const CompareJob& job_;
  Isa isa_;
  Mapper mapper_;
  MotionModel motion_;
  std::vector<PointCells> points_;
  std::vector<std::uint16_t> values_;
  CompareOutcome outcome_;
};

// Counts the scans of the run, so that the measured ones are spread evenly.
std::uint64_t count_scans(const CompareJob& job, const std::function<bool()>& stop) {
  ScanStream scans(job.logs, job.read, job.range);
  if (scans.nod_kind() != NodKind::kNone) {
    throw InputError(FilePosition{log_name(job.logs.front()), 0},
                     "its laser nods, and scans that are not level cannot be compared; give the log of a fixed laser");
  }
  std::uint64_t count = 0;
  while (scans.next()) {
    if (stop()) throw Error(ExitCode::kInterrupted, "interrupted; nothing is written");
    ++count;
  }
  return count;
}

}  // namespace

CompareOutcome compare(const CompareJob& job, Backend& backend, const CompareProgress& progress,
                       const std::function<bool()>& stop) {
  const std::uint64_t count = count_scans(job, stop);
  if (count == 0) {
    throw InputError(FilePosition{log_name(job.logs.front()), 0},
                     job.range.skip > 0 ? fmt::format("holds no laser scan after the {} of --skip", job.range.skip)
                                        : "holds no laser scan");
  }
  ScanStream scans(job.logs, job.read, job.range);
  CompareOutcome outcome =
      Comparison(job, backend, std::max<std::uint64_t>(count / job.scans, 1)).run(scans, progress, stop);
  if (!outcome.scans.empty()) return outcome;
  throw InputError(FilePosition{log_name(job.logs.front()), 0},
                   fmt::format("none of its {} scans could be measured: {} were not matched, {} have fewer than {} "
                               "returns near what was mapped before",
                               count, outcome.refused, outcome.too_few, job.mapper.scan.min_points));
}

bool CompareTrial::is_success() const { return distance_m <= kSuccess_m && theta_rad <= rad_from_deg(kSuccess_deg); }

}  // namespace gdtslam
