// The folder of a run as those read it who draw, join, edit or localise: an input holds its files.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/io/sha256.hpp"
#include "engine/runs/edits/source_run.hpp"
#include "engine/runs/folder/run_graph.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/localizer/map_field.hpp"
#include "engine/runs/sites/run_session.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/io/occupancy_map_file.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {
namespace detail {

using RunFiles = std::map<std::string, std::string, std::less<>>;

inline void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

/// Checksums that hold: in the keyframes that of config.yaml and at the end their own, which the report tells where it
/// says KEYFRAMES.
inline void mend_checksums(RunFiles& files) {
  constexpr std::size_t kConfigHash = 20;  // behind the name and the version of the format
  constexpr std::size_t kHash = 64;
  const auto keyframes = files.find("keyframes.bin.gz");
  if (keyframes == files.end()) return;
  std::string& bytes = keyframes->second;
  const auto config = files.find("config.yaml");
  if (bytes.size() > kConfigHash + kHash && config != files.end()) {
    bytes.replace(kConfigHash, kHash, Sha256().update(std::string_view(config->second)).hex());
  }
  const std::string hash = Sha256().update(std::string_view(bytes)).hex();
  bytes += hash;
  replace_all(files["report.json"], "KEYFRAMES", hash);
}

inline void check_summary(const RunSummary& run) {
  for (const std::vector<std::size_t>* const list : {&run.doubtful, &run.keyframes, &run.drives}) {
    for (const std::size_t scan : *list) require(scan < run.scans);
  }
  require(!run.logs.empty());
}

/// Every file that the reader gives.
inline void check_members(const RunReader& run) {
  expect_typed<InputError>([&] { require(run.trajectory().size() == run.summary().scans); });
  expect_typed<InputError>([&] {
    if (const auto covariances = run.covariances()) require(covariances->size() == run.summary().scans);
  });
  expect_typed<InputError>([&] {
    const RunDoubts doubts = run.doubts();
    if (!doubts.loops) return;
    for (const ClosedLoop& loop : doubts.loops->loops) require(std::max(loop.from, loop.to) < run.summary().scans);
  });
  expect_typed<InputError, FileError>([&] { require(run.map().geometry == *run.summary().map); });
  expect_typed<ConfigError, InputError>([&] { static_cast<void>(run.settings()); });
  expect_typed<InputError>([&] {
    if (const auto kept = run.keyframes()) require(kept->keyframes.size() == run.summary().keyframes.size());
  });
  expect_typed<ConfigError, InputError>([&] { static_cast<void>(run.linkage()); });
  expect_typed<InputError>([&] {
    const RunGraph graph = read_run_graph(run);
    const std::size_t places = graph.graph.poses.size();
    require(graph.scans.size() == places && graph.is_on.size() == graph.graph.loops.size());
    for (const PoseRelation& step : graph.graph.path) require(step.from < places && step.to < places);
  });
}

}  // namespace detail

/// The report comes first, then each file behind a line "=== NAME".
inline void read_run_folder(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  constexpr std::array<std::string_view, 9> kNames{"report.json", "trajectory.tum",   "covariance.csv",
                                                   "graph.g2o",   "keyframes.bin.gz", "config.yaml",
                                                   "map.yaml",    "map.pgm",          "edits.json"};
  detail::RunFiles files = files_in(text_of(data), std::string(kNames[0]));
  detail::mend_checksums(files);
  put_files(folder, files, kNames);
  static_cast<void>(RunReader::is_gdtslam_run(folder.path()));
  expect_typed<InputError>([] {
    const RunReader run(folder.path());
    detail::check_summary(run.summary());
    require(!run.name().empty());
    detail::check_members(run);
  });
  expect_typed<InputError, ConfigError, FileError>([] {
    const RunSession session = read_run_session(folder.path());
    require(session.session.poses.size() == session.kept.keyframes.size());
  });
  expect_typed<InputError, ConfigError, FileError>([] {
    const SourceRun source = read_source_run(folder.path());
    require(source.outcome.trajectory.size() == source.reader.summary().scans);
  });
}

/// A map as `localize` takes it, of this or another program: what it makes of it, beside an image or a field.
inline void read_localizer_map(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const bool is_ready = [] {
    folder.put("map.pgm", std::string_view("P5\n3 2\n255\n\x00\xfe\xcd\xfe\xfe\x00", 17));
    const std::vector<std::uint16_t> cells{0, 256, 5120};
    write_distance_field(folder.file("gdt.yaml"), rows_of(DistanceFieldView{{0.05, 1.0, 2.0, 3, 1}, 3, cells, 5120}));
    return true;
  }();
  require(is_ready);
  expect_typed<InputError, FileError>([&] {
    const MapField field = read_map_field(folder.put("map.yaml", text_of(data)), MapConfig());
    const FieldView view = field.view();
    require(view.width > 0 && view.height > 0 && view.stride >= view.width && field.kernel_origin_m.allFinite());
    const PoseWindow window = field.known_window();
    require(window.centre.is_finite() && window.half_x_m > 0.0 && window.half_y_m > 0.0);
  });
}

inline constexpr std::array kRunFolderTargets{FuzzTarget{"run", read_run_folder, 4},
                                              FuzzTarget{"localizer_map", read_localizer_map, 4}};

}  // namespace gdtslam::fuzz
