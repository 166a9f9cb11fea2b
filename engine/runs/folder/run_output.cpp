#include "run_output.hpp"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/io/maps/png.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#ifdef GDTSLAM_HAS_RASTER
#include "gdtslam/drawing/raster.hpp"
#endif

namespace gdtslam {
namespace {

// The map with the path on it, to look at.
Canvas overview_of(const MapJob& job, const MapOutcome& outcome) {
  PathOverlay overlay{outcome.trajectory, outcome.keyframes, {}};
  for (const DoubtfulScan& scan : outcome.doubtful) overlay.doubtful.push_back(scan.index);
  const MapperStatistics& s = outcome.statistics;
  const GridGeometry& geometry = outcome.occupancy.geometry;
  MapLook look;
  look.title = std::filesystem::path(log_name(job.logs.front())).filename().string();
  look.subtitle =
      fmt::format("{} scans, {} matched, {} doubtful, {} keyframes, {:.1f} m; {}x{} cells of {:g} m", scans_of(outcome),
                  s.matched, s.doubtful, s.keyframes, s.path_m, geometry.width, geometry.height, geometry.resolution_m);
  return map_picture(outcome.occupancy, overlay, look, size_for_content(geometry.width, geometry.height));
}

std::string png_of(const RgbaImage& image) { return encode_png(image.width, image.height, image.pixels); }

// Pixels; where this build has nothing that makes them, or the machine no font, a drawing that a browser shows.
void write_overview(RunFolder& folder, const Canvas& overview) {
#ifdef GDTSLAM_HAS_RASTER
  try {
    const std::string png = png_of(raster_of(overview));
    write_file_atomically(folder.staged("overview.png"), png);
    folder.without("overview.svg");
    return;
  } catch (const UnavailableError&) {  // the run is as good without letters
  }
#endif
  write_file_atomically(folder.staged("overview.svg"), svg_of(overview, png_of));
  folder.without("overview.png");
}

}  // namespace

std::string write_run(RunFolder& folder, const MapJob& job, const NoddingJob* nodding, const MapOutcome& outcome,
                      const Mapper& mapper, const DeviceInfo& device, Settings settings) {
  const auto start = std::chrono::steady_clock::now();
  // The order in which the files take their names: what others refer to first, then the YAML that refers to them, and
  // last the report, without which a folder is no run.
  const std::string trajectory = folder.staged("trajectory.tum");
  if (job.with_pictures) {
    write_overview(folder, overview_of(job, outcome));
  } else {
    for (const char* name : {"overview.png", "overview.svg"}) folder.without(name);
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
  std::string report = json_text(run_report(job, nodding, outcome, mapper, device, written_s));
  write_file_atomically(report_file, report);
  folder.commit();
  return report;
}

}  // namespace gdtslam
