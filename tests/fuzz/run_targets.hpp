// Single files of runs, of atlases and of those who calibrate or edit.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/runs/continuing/continue_file.hpp"
#include "engine/runs/edits/edit_arguments.hpp"
#include "engine/runs/edits/edits_file.hpp"
#include "engine/runs/edits/georeference.hpp"
#include "engine/runs/fleet/plan.hpp"
#include "engine/runs/fleet/record.hpp"
#include "engine/runs/keyframes/keyframe_file.hpp"
#include "engine/runs/linkage/linkage_file.hpp"
#include "engine/runs/loops/covariance_file.hpp"
#include "engine/runs/loops/graph_file.hpp"
#include "engine/runs/tiles/tile_folder.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {

inline void read_linkage_description(std::span<const std::byte> data) {
  expect_typed<ConfigError>([&] {
    const LinkageFile linkage = read_linkage_text(std::string(text_of(data)), "fuzz");
    require(calib::validate(linkage.model).empty());
    const std::string written = linkage_text(linkage.model, linkage.uncertainty);
    const LinkageFile again = read_linkage_text(written, "written");
    require(linkage_text(again.model, again.uncertainty) == written);
    require(again.uncertainty == linkage.uncertainty);
    const ElevationTable table = elevation_table(linkage.model, 6);
    for (const double elevation_rad : table.values_rad()) require(std::isfinite(elevation_rad));
  });
}

/// The bytes within the packing and before the checksum, which a fuzzer could not guess.
inline void read_keyframe_bytes(std::span<const std::byte> data) {
  expect_typed<InputError>([&] {
    const RunKeyframes run = parse_keyframes(text_of(data), "fuzz");
    std::size_t beams = 0;
    for (const RunKeyframe& keyframe : run.keyframes) {
      require(keyframe.T_map_base.is_finite() && std::isfinite(keyframe.laser.stamp_s));
      for (const float range_m : keyframe.laser.ranges_m) require(range_m > 0.0F);
      beams += keyframe.laser.ranges_m.size();
    }
    require(beams < data.size());
    const std::string written = keyframe_bytes(run);
    require(keyframe_bytes(parse_keyframes(written, "written")) == written);
  });
}

inline void read_edits_text(std::span<const std::byte> data) {
  expect_typed<InputError>([&] {
    const RecordedEdits edits = parse_edits(text_of(data), "fuzz");
    const EditPlan plan = plan_of(edits.steps);
    require(plan.T_edited_run.is_finite() && (!plan.T_world_edited || plan.T_world_edited->is_finite()));
    for (const MapRegion& region : plan.erased) require(region.corners_m.size() >= 3);
    for (const MapRegion& region : plan.kept) require(region.corners_m.size() == 4);
    const std::string written = edits_text(edits, 0);
    require(edits_text(parse_edits(written, "written"), 0) == written);
  });
}

/// The plan of an atlas, a record, a table of records.
inline void read_fleet_text(std::span<const std::byte> data) {
  const std::string_view text = text_of(data);
  expect_typed<InputError>([&] {
    const FleetPlan plan = parse_plan(text, "fuzz");
    const std::string written = plan_text(plan);
    require(plan_text(parse_plan(written, "written")) == written);
  });
  expect_typed<InputError>([&] {
    const UnitRecord record = parse_record(text, "fuzz");
    const std::string written = record_text(record);
    require(record_text(parse_record(written, "written")) == written);
    require(run_path(record.run).find("..") == std::string::npos);
  });
  const std::string plan = "0123456789abcdef";
  if (const auto records = parse_records_table(text, plan)) {
    require(parse_records_table(records_table(plan, *records), plan).has_value());
  }
}

inline void read_covariance_rows(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  expect_typed<InputError>([&] {
    Trajectory stamps;
    std::vector<PoseCovariance> covariances;
    for (const StampedCovariance& row : read_covariances(folder.put("covariance.csv", text_of(data)))) {
      stamps.push_back({row.stamp_s, {}});
      covariances.push_back(row.covariance);
    }
    const std::string written = covariance_text(stamps, covariances);
    const std::vector<StampedCovariance> again = read_covariances(folder.put("again.csv", written));
    require(again.size() == covariances.size());
    for (std::size_t k = 0; k < again.size(); ++k) {
      require(again[k].covariance.xx == covariances[k].xx && again[k].covariance.yt == covariances[k].yt);
    }
  });
}

inline void read_graph_lines(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  expect_typed<InputError>([&] {
    const std::string written = graph_lines_text(read_graph(folder.put("graph.g2o", text_of(data))));
    require(graph_lines_text(read_graph(folder.put("again.g2o", written))) == written);
  });
}

/// The index of tiles, in a folder that has some near the origin and at the ends of what an index may name.
inline void read_tiles(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const bool is_ready = [] {
    for (const char* place : {"0_0", "1_0", "0_-1", "524288_524288", "524287_524287", "-524287_-524287"}) {
      for (const char* what : {"gdt_", "map_"}) folder.put(std::string(what) + place + ".yaml", "");
    }
    return true;
  }();
  require(is_ready);
  expect_typed<InputError>([&] {
    folder.put("index.json", text_of(data));
    const TileIndex index = read_tile_index(folder.path());
    const GridGeometry grid = geometry_of(index);
    require(grid.width >= 0 && grid.height >= 0 && grid.resolution_m > 0.0 && std::isfinite(grid.resolution_m));
    require(std::isfinite(grid.origin_x_m) && std::isfinite(grid.origin_y_m));
    require(sha256_of(index).size() == 64);
    write_tile_index(folder.path(), index);
    require(sha256_of(read_tile_index(folder.path())) == sha256_of(index));
  });
}

/// Polygons and points that are known in the world, in a file and, where they name none, as an option's text.
inline void read_places(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  const std::string file = folder.put("places", text_of(data));
  expect_typed<InputError>([&] {
    const MapRegion region = parse_region(file);
    require(region.corners_m.size() >= 3);
    for (const Point2& corner : region.corners_m) require(corner.allFinite());
  });
  expect_typed<InputError>([&] {
    const Georeference fitted = fit_georeference(parse_point_pairs(file));
    require(fitted.T_world_map.is_finite() && std::isfinite(fitted.rms_m) && std::isfinite(fitted.scale));
  });
  const std::string text(text_of(data));
  std::error_code ignored;
  if (std::filesystem::exists(text, ignored)) return;  // that would be another file of this machine
  expect_typed<UsageError>([&] { require(parse_region(text).corners_m.size() >= 3); });
  expect_typed<UsageError>([&] { require(!parse_point_pairs(text).empty()); });
  expect_typed<UsageError>([&] { require(parse_origin(text).pose.is_finite()); });
  expect_typed<UsageError>([&] {
    const RegionBounds bounds = parse_rectangle(text);
    require(bounds.low_m.x() < bounds.high_m.x() && bounds.low_m.y() < bounds.high_m.y());
  });
}

inline constexpr std::array kRunTargets{
    FuzzTarget{"linkage", read_linkage_description, 12},
    FuzzTarget{"keyframes", read_keyframe_bytes, 8},
    FuzzTarget{"edits", read_edits_text, 8},
    FuzzTarget{"fleet", read_fleet_text, 8},
    FuzzTarget{"covariance", read_covariance_rows, 3},
    FuzzTarget{"graph", read_graph_lines, 3},
    FuzzTarget{"tiles", read_tiles, 3},
    FuzzTarget{"places", read_places, 4},
};

}  // namespace gdtslam::fuzz
