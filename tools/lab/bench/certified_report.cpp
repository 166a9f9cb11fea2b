// The report of `gdtslam bench certified`: a table for people, JSON for programs.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "certified.hpp"
#include "engine/io/json_file.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

std::string window_text(const CertifiedBenchRow& row) {
  return row.half_rad >= kPi ? fmt::format("+-{:g} m, 360 deg", row.half_m)
                             : fmt::format("+-{:g} m, +-{:.0f} deg", row.half_m, deg_from_rad(row.half_rad));
}

std::string lattice_text(const CertifiedBenchRow& row) {
  if (row.lattice_scans == 0) return "";
  return fmt::format(" | {:>11} {:>5} {:>10.1f} {:>7.0f} {:>5.0f} %", row.lattice_poses, row.lattice_scans,
                     1e3 * row.lattice_median_s, row.times_lattice(), 100.0 * row.lattice_best_share);
}

std::string row_text(const CertifiedBenchRow& row) {
  return fmt::format("{:<18} {:>9.2f} {:>8.2f} {:>8.2f} {:>9.0f} {:>9} {:>5.0f} % {:>5.0f} %{}\n", window_text(row),
                     1e3 * row.median_s, 1e3 * row.p90_s, 1e3 * row.most_s, row.median_boxes, row.most_boxes,
                     100.0 * row.proven_share, 100.0 * row.known_share, lattice_text(row));
}

Json lattice_json(const CertifiedBenchRow& row) {
  if (row.lattice_scans == 0) return {};
  return {{"poses", row.lattice_poses},
          {"scans", row.lattice_scans},
          {"cpu_median_s", row.lattice_median_s},
          {"times_certified", row.times_lattice()},
          {"best_share", row.lattice_best_share}};
}

Json row_json(const CertifiedBenchRow& row) {
  return {{"half_m", row.half_m},
          {"half_rad", row.half_rad},
          {"cpu_median_s", row.median_s},
          {"cpu_p90_s", row.p90_s},
          {"cpu_most_s", row.most_s},
          {"median_boxes", row.median_boxes},
          {"most_boxes", row.most_boxes},
          {"median_evaluations", row.median_evaluations},
          {"proven_share", row.proven_share},
          {"known_share", row.known_share},
          {"lattice", lattice_json(row)}};
}

std::string name_of_log(const std::string& path) { return path.substr(path.rfind('/') + 1); }

}  // namespace

std::string as_text(const CertifiedBenchJob& job, const CertifiedBench& bench, const Backend& backend) {
  const DeviceInfo& device = backend.device();
  std::string text = fmt::format("gdtslam {}\ncpu       {}, {}, one thread\n", GDTSLAM_VERSION, device.name,
                                 to_string(backend.host_isa()));
  text += fmt::format(
      "{}: {} scans mapped, {} of them looked for in their map, {:.0f} returns, gap {:g} mm\n"
      "map: {} x {} cells, {:.1f} MB; prepared in {:.0f} ms, {:.1f} MB more\n",
      name_of_log(job.log), bench.log_scans, bench.scans, bench.median_points, 1e3 * job.gap_m, bench.map_width,
      bench.map_height, 1e-6 * static_cast<double>(bench.map_bytes), 1e3 * bench.prepare_s,
      1e-6 * static_cast<double>(bench.prepared_bytes));
  const bool has_lattice = job.lattice_s > 0.0;
  text += fmt::format("{:<18} {:>9} {:>8} {:>8} {:>9} {:>9} {:>7} {:>7}", "window", "median ms", "90 % ms", "most ms",
                      "boxes", "most", "proven", "known");
  if (has_lattice) {
    text += fmt::format(" | {:>11} {:>5} {:>10} {:>7} {:>7}", "poses", "scans", "median ms", "times", "best");
  }
  text += "\n";
  for (const CertifiedBenchRow& row : bench.rows) text += row_text(row);
  text +=
      "ms: CPU time of a search, from the points to the proof; no other matcher comes before it. boxes: bounded, "
      "median and most.\nknown: within 10 cm and 1 degree of where mapping had the scan, the window's centre being off "
      "by up to 80 % of its half width.\n";
  if (has_lattice) {
    text +=
        "Right of the bar the peer: all poses of a lattice of 5 cm and 1 degree in the same window, then a descent "
        "from the best.\ntimes: its time over that of the search; best: ended within the gap of the least cost.\n";
  }
  return text;
}

std::string json_text_of(const CertifiedBenchJob& job, const CertifiedBench& bench, const Backend& backend) {
  Json rows = Json::array();
  for (const CertifiedBenchRow& row : bench.rows) rows.push_back(row_json(row));
  const Json report{{"version", GDTSLAM_VERSION},
                    {"device", backend.device().name},
                    {"isa", to_string(backend.host_isa())},
                    {"log", name_of_log(job.log)},
                    {"log_scans", bench.log_scans},
                    {"scans", bench.scans},
                    {"median_points", bench.median_points},
                    {"gap_m", job.gap_m},
                    {"map",
                     {{"width", bench.map_width},
                      {"height", bench.map_height},
                      {"bytes", bench.map_bytes},
                      {"prepare_cpu_s", bench.prepare_s},
                      {"prepared_bytes", bench.prepared_bytes}}},
                    {"lattice_step_m", kLatticeStep_m},
                    {"lattice_step_rad", kLatticeStep_rad},
                    {"windows", rows}};
  return json_text(report);
}

}  // namespace gdtslam
