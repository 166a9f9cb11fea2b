#include "track_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "engine/runs/localizer/drive_figures.hpp"
#include "gdtslam/core/angle.hpp"
#include "output_parts.hpp"
#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

std::string stretches_text(const DriveFigures& figures) {
  constexpr std::size_t kMostListed = 20;
  std::string text;
  const std::size_t listed = std::min(figures.stretches.size(), kMostListed);
  for (std::size_t k = 0; k < listed; ++k) {
    const UnknownStretch& stretch = figures.stretches[k];
    text += fmt::format("  from scan {}: {}, {:.1f} s, {}\n", stretch.first, plural(stretch.scans, "scan"),
                        stretch.lasted_s, stretch.is_found ? "then found" : "not found any more");
  }
  if (figures.stretches.size() > listed) {
    text += fmt::format("  and {} stretches more\n", figures.stretches.size() - listed);
  }
  return text;
}

std::string share_text(const LocalizeLimits& limits, const DriveFigures& figures) {
  const Share& within = figures.within;
  if (within.of == 0) return fmt::format("the map has the place of none of the {} references\n", figures.unmapped);
  std::string text = fmt::format(
      "within {:g} cm and {:g} deg of the reference where the map has the place: {} of {}, {:.2f} %; not known {}, "
      "off {}; the map does not have the place of {}\n",
      100.0 * limits.within_m, deg_from_rad(limits.within_rad), within.count, within.of, 100.0 * within.value(),
      figures.without, figures.off, figures.unmapped);
  if (within.count == 0) return text;
  return text + fmt::format("  those within: median {:.1f} cm and {:.2f} deg, mean {:.1f} cm and {:.2f} deg\n",
                            100.0 * figures.distance_m.median, figures.angle_deg.median,
                            100.0 * figures.distance_m.mean, figures.angle_deg.mean);
}

Json stretches_json(const DriveFigures& figures) {
  Json stretches = Json::array();
  for (const UnknownStretch& stretch : figures.stretches) {
    stretches.push_back({{"scan", stretch.first},
                         {"scans", stretch.scans},
                         {"lasted_s", stretch.lasted_s},
                         {"found", stretch.is_found}});
  }
  return stretches;
}

Json compared_json(const LocalizeJob& job, const LocalizeLimits& limits, const DriveFigures& figures) {
  if (!job.reference) return nullptr;
  return {{"reference", job.reference->file()},
          {"aligned", job.reference->is_aligned()},
          {"within_m", limits.within_m},
          {"within_deg", deg_from_rad(limits.within_rad)},
          {"within", share_json(figures.within)},
          {"unknown", figures.without},
          {"off", figures.off},
          {"unmapped", figures.unmapped},
          {"distance_m", error_json(figures.distance_m)},
          {"angle_deg", error_json(figures.angle_deg)},
          {"squared_sigmas", error_json(figures.squared_sigmas)}};
}

Json step_json(const StepTimes& times) {
  return {{"count", times.count}, {"median_s", times.median_s}, {"p99_s", times.p99_s}, {"max_s", times.max_s}};
}

}  // namespace

std::string as_text(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive) {
  const DriveFigures figures = figures_of(drive);
  std::string counts;
  for (const Whereabouts whereabouts : kWhereabouts) {
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ",
                          figures.whereabouts[static_cast<std::size_t>(whereabouts)], to_string(whereabouts));
  }
  std::string text =
      fmt::format("{}: {}; {} ambiguous; {} {} of the whole map\n", plural(drive.scans.size(), "scan"), counts,
                  figures.ambiguous, figures.searches, figures.searches == 1 ? "search" : "searches");
  if (!figures.stretches.empty()) text += "where nothing is known:\n" + stretches_text(figures);
  text += fit_text(localizer.good_fit());
  return job.reference ? text + share_text(localizer.limits(), figures) : text;
}

Json as_json(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive,
             const LocalizeTimes& times) {
  const DriveFigures figures = figures_of(drive);
  Json counts = Json::object();
  for (const Whereabouts whereabouts : kWhereabouts) {
    counts[std::string(to_string(whereabouts))] = figures.whereabouts[static_cast<std::size_t>(whereabouts)];
  }
  Json warnings = Json::object();
  for (const LogReader::Warning& warning : drive.warnings) warnings[warning.kind] = warning.count;
  return {{"map", localizer.file()},
          {"log", job.log},
          {"field", field_json(localizer.field())},
          {"good_fit", fit_json(localizer.good_fit())},
          {"first", job.choice.first},
          {"scans", drive.scans.size()},
          {"interrupted", drive.interrupted},
          {"whereabouts", counts},
          {"ambiguous", figures.ambiguous},
          {"searches", figures.searches},
          {"unknown", stretches_json(figures)},
          {"errors", compared_json(job, localizer.limits(), figures)},
          {"warnings", warnings},
          {"times",
           {{"device", times.device},
            {"wall_s", times.wall_s},
            {"cpu_s", times.cpu_s},
            {"tracked", step_json(times_of(drive, false))},
            {"searched", step_json(times_of(drive, true))}}}};
}

}  // namespace gdtslam
