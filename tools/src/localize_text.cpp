#include "localize_text.hpp"

#include <fmt/format.h>

#include <cmath>

#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

std::string proof_text(const CertifiedResult& found) {
  if (found.certified()) return fmt::format("no pose is better by more than {:.2f} mm", 1000.0 * found.gap_m);
  return fmt::format("not proven ({}): a pose may be better by {:.2f} mm", name_of(found.stop), 1000.0 * found.gap_m);
}

std::string runner_up_text(const LocalizedScan& scan) {
  if (!scan.runner_up) return "";
  if (scan.runner_up->stop == CertifiedStop::kNothingAllowed) return "  elsewhere: no pose in the map\n";
  const Pose2 apart = between(scan.best->T_map_base, scan.runner_up->T_map_base);
  return fmt::format(
      "  elsewhere, {:.2f} m and {:.1f} deg away: mean distance {:.1f} mm, nowhere less than {:.1f} mm{}\n",
      apart.translation().norm(), std::fabs(deg_from_rad(apart.theta_rad)), 1000.0 * scan.runner_up->mean_cost_m,
      1000.0 * scan.runner_up->mean_bound_m, scan.is_ambiguous() ? "; AMBIGUOUS: it may be as good" : "");
}

std::string reference_text(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.reference) return "";
  const ReferencePose& reference = *scan.reference;
  const Pose2& T = reference.T_map_base;
  std::string text =
      fmt::format("  reference: x {:.3f} m, y {:.3f} m, heading {:.2f} deg", T.x_m, T.y_m, deg_from_rad(T.theta_rad));
  if (scan.best) {
    text += fmt::format("; {:.3f} m and {:.2f} deg off", reference.distance_m, deg_from_rad(reference.angle_rad));
  }
  const LocalizeFault fault = fault_of(scan, limits);
  if (fault == LocalizeFault::kNone || !scan.has_returns) return text + "\n";
  text += fmt::format(": {}\n", text_of(fault));
  if (!reference.nearby) return text;
  return text + fmt::format(
                    "  within {:g} cm and {:g} deg of it: mean distance {:.1f} mm, nowhere less than {:.1f} mm; "
                    "{:.0f} % of the points near an obstacle there\n",
                    100.0 * limits.within_m, deg_from_rad(limits.within_rad), 1000.0 * reference.nearby->mean_cost_m,
                    1000.0 * reference.nearby->mean_bound_m, 100.0 * reference.known_share);
}

std::string scan_text(const LocalizedScan& scan, const LocalizeLimits& limits) {
  if (!scan.best) {
    const std::string why =
        scan.has_returns ? "no pose: the search was cut short" : fmt::format("too few returns, {}", scan.points);
    return fmt::format("scan {} at {:.6f} s: {}\n", scan.index, scan.stamp_s, why) + reference_text(scan, limits);
  }
  const Pose2& T = scan.best->T_map_base;
  return fmt::format("scan {} at {:.6f} s: x {:.3f} m, y {:.3f} m, heading {:.2f} deg\n", scan.index, scan.stamp_s,
                     T.x_m, T.y_m, deg_from_rad(T.theta_rad)) +
         fmt::format("  mean distance {:.1f} mm of {} points; {}\n", 1000.0 * scan.best->mean_cost_m, scan.points,
                     proof_text(*scan.best)) +
         runner_up_text(scan) + reference_text(scan, limits);
}

std::string chosen_text(const LocalizeJob& job, const Localized& all, const LocalizeFigures& figures) {
  std::string text = fmt::format("{} scans", all.scans.size());
  if (job.choice.random > 0) text += fmt::format(" at random of {}", all.candidates);
  if (job.merged) {
    text += fmt::format(", {} {} left out", all.left_out, near_text(*job.merged));
  }
  if (all.without_reference > 0) text += fmt::format(", {} without a reference", all.without_reference);
  text += fmt::format(": {} proven, {} ambiguous", figures.certified, figures.ambiguous);
  const std::uint64_t lost = all.scans.size() - figures.found;
  return text + (lost > 0 ? fmt::format(", {} without a pose\n", lost) : "\n");
}

std::string within_text(const LocalizeLimits& limits, const LocalizeFigures& figures) {
  const Share& within = figures.within;
  std::string text = fmt::format(
      "within {:g} cm and {:g} deg of the reference: {} of {}, {:.1f} % (95 %: {:.1f} to "
      "{:.1f} %)\n",
      100.0 * limits.within_m, deg_from_rad(limits.within_rad), within.count, within.of, 100.0 * within.value(),
      100.0 * within.low(), 100.0 * within.high());
  if (within.count > 0) {
    text += fmt::format("  these: median {:.1f} cm and {:.2f} deg, mean {:.1f} cm and {:.2f} deg\n",
                        100.0 * figures.distance_m.median, figures.angle_deg.median, 100.0 * figures.distance_m.mean,
                        figures.angle_deg.mean);
  }
  for (std::size_t k = 0; k < kLocalizeFaults.size(); ++k) {
    if (figures.faults[k] > 0) text += fmt::format("  {}: {}\n", text_of(kLocalizeFaults[k]), figures.faults[k]);
  }
  return text;
}

}  // namespace

std::string text_of(const LocalizeJob& job, const Localizer& localizer, const Localized& all) {
  const LocalizeLimits& limits = localizer.limits();
  const LocalizeFigures figures = figures_of(all.scans, limits);
  const bool is_alone = job.choice.random == 0 && job.choice.every == 0;
  std::string text;
  for (const LocalizedScan& scan : all.scans) {
    const bool is_right = scan.reference && fault_of(scan, limits) == LocalizeFault::kNone;
    if (is_alone || !is_right) text += scan_text(scan, limits);
  }
  if (is_alone) return text;
  text += chosen_text(job, all, figures);
  if (figures.within.of > 0) text += within_text(limits, figures);
  return text;
}

}  // namespace gdtslam
