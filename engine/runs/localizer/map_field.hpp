// The distance field that scans are searched in: of a run, or of an occupancy map that any program made. Frame: the
// map's own, metres. Thread-safe once read; O(cells).
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/io/distance_field_file.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// A field with the file that it comes from.
struct MapField {
  enum class Source : std::uint8_t { kDistances, kOccupiedCells };
  std::string path;
  Source source = Source::kDistances;
  DistanceFieldFile file;
  /// Whose folder was named, and checked; a file that is named itself is taken as it is, and so is an older run.
  std::optional<RunReader> run{};
  /// Where the origin of the kernels' frame lies in the map, parallel to it: they count in whole cells from there. The
  /// map's own origin for a run, whose cells lie on it; the field's corner for an occupancy map, whose cells may not,
  /// and whose origin may be far away.
  Point2 kernel_origin_m = Point2::Zero();

  /// Valid as long as this stays where it is; in the kernels' frame.
  [[nodiscard]] FieldView view() const;
  /// Every place that the field knows, in every heading.
  [[nodiscard]] PoseWindow known_window() const;
};

/// With the cap around it, two cells wide, as searches and kernels need it: a field that ends where the map does not,
/// as that of a tile, has none. O(cells).
MapField framed(MapField field);

/// Whether that is a folder with a gdt.yaml, or a file that may be a map's description by its name.
bool looks_like_map(const std::string& path);

/// Whether the description is of an occupancy map, whose own keys may all be missing, and not of a field, which has its
/// version. False for what is no file. Throws InputError.
bool is_occupancy_map(const std::string& path);

/// `map` is a run folder, its gdt.yaml, or the map.yaml of an occupancy map, whose distances are kept up to
/// `config.truncation_m`. Throws InputError, also where no cell of it is occupied; FileError.
MapField read_map_field(const std::string& map, const MapConfig& config);

/// The map to draw: the occupancy map of the run or of its own, else walls made of the distances.
OccupancyMap shown_map(const MapField& field);

}  // namespace gdtslam
