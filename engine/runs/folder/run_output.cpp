#include "run_output.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/maps/overview.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"

namespace gdtslam {
namespace {

OverviewInput overview_of(const MapJob& job, const MapOutcome& outcome) {
  OverviewInput input{.map = outcome.occupancy, .trajectory = outcome.trajectory};
  for (const DoubtfulScan& scan : outcome.doubtful) input.doubtful.push_back(scan.index);
  input.keyframes = outcome.keyframes;
  const MapperStatistics& s = outcome.statistics;
  input.title = std::filesystem::path(log_name(job.logs.front())).filename().string();
  input.caption =
      fmt::format("{} scans, {} matched, {} doubtful, {} keyframes, {:.1f} m; {}x{} cells of {:g} m", scans_of(outcome),
                  s.matched, s.doubtful, s.keyframes, s.path_m, outcome.occupancy.geometry.width,
                  outcome.occupancy.geometry.height, outcome.occupancy.geometry.resolution_m);
  return input;
}

}  // namespace

std::string write_run(RunFolder& folder, const MapJob& job, const MapOutcome& outcome, const NoddingReport* nodding,
                      const Mapper& mapper, const DeviceInfo& device, Settings settings) {
  const auto start = std::chrono::steady_clock::now();
  // The order in which the files take their names: what others refer to first, then the YAML that refers to them, and
  // last the report, without which a folder is no run.
  const std::string trajectory = folder.staged("trajectory.tum");
  if (job.with_pictures) {
    write_overview(folder.staged("overview.png"), overview_of(job, outcome));
  } else {
    folder.without("overview.png");
  }
  const std::string config = folder.staged("config.yaml");
  folder.staged("map.pgm");
  folder.staged("gdt.png");
  const std::string map = folder.staged("map.yaml");
  const std::string field = folder.staged("gdt.yaml");
  const std::string report_file = folder.staged("report.json");
  write_tum(trajectory, outcome.trajectory);
  write_occupancy_map(map, outcome.occupancy);
  write_distance_field(field, view_of(mapper.field()));
  write_config(config, option_table(settings));
  const double written_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::string report = json_text(report_of(job, outcome, nodding, mapper, device, written_s));
  write_file_atomically(report_file, report);
  folder.commit();
  return report;
}

}  // namespace gdtslam
