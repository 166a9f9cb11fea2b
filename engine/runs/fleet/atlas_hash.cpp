#include "atlas_hash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "engine/io/sha256.hpp"
#include "engine/runs/folder/run_files.hpp"

namespace gdtslam {
namespace {

constexpr std::array kHashedFiles{"cloud.ply",    "config.yaml", "covariance.csv", "gdt.yaml",      "graph.g2o",
                                  "linkage.yaml", "map.pgm",     "map.yaml",       "trajectory.tum"};
constexpr std::array kHashedKeys{"map_sha256", "trajectory_sha256", "keyframes_sha256"};

}  // namespace

std::string result_sha256_of(const std::string& run_folder) {
  Sha256 hash;
  const RunFiles files(run_folder);
  const ReportReader report = files.report();
  for (const char* key : kHashedKeys) {
    if (report.has(key)) hash.update(fmt::format("{} {}\n", key, report.text(key)));
  }
  for (const char* name : kHashedFiles) {
    if (files.has(name)) hash.update(fmt::format("{} {}\n", name, files.sha256(name)));
  }
  return hash.hex();
}

std::string atlas_sha256_of(const AtlasState& state) {
  std::vector<std::string> lines;
  lines.reserve(state.records.size());
  for (const std::optional<UnitRecord>& record : state.records) {
    lines.push_back(record ? fmt::format("{} {} {} {}\n", record->run, record->input_sha256,
                                         record->is_mapped() ? "mapped" : "refused", record->result_sha256)
                           : "missing\n");
  }
  std::sort(lines.begin(), lines.end());
  Sha256 hash;
  for (const std::string& line : lines) hash.update(line);
  return hash.hex();
}

}  // namespace gdtslam
