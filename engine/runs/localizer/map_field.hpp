// How well a scan of the mapped place fits, and the run that a map belongs to. Thread-safe; O(n log n).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/io/map_files.hpp"
#include "gdtslam/mapping/certified.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/occupancy.hpp"

namespace gdtslam {

/// The run folder that a map belongs to: itself, or the folder of its gdt.yaml; none where that is none.
std::optional<std::string> find_run_folder(const std::string& map);

/// How well a scan of the mapped place fits: mean distances of its points to the map's obstacles.
struct FitLimit {
  /// The largest comes from an option, from 99 of 100 of the run's own scans, or from the size of the map's cells.
  enum class Source : std::uint8_t { kOption, kRun, kResolution };
  double distance_m = 0.0;  ///< the largest that is a good fit
  Source source = Source::kOption;
  double usual_m = 0.0;  ///< the median
};
/// From the mean distances that the run's own scans leave in the finished map. Two cells are always a good fit: the
/// most that rounding to cells in the scan and in the map can account for, while scans that a map was made of fit it
/// better than others. Without scans one cell is usual.
FitLimit make_fit_limit(std::vector<double> own_m, double resolution_m);

// The distance field that scans are searched in: of a run, or of an occupancy map that any program made. Frame: the
// map's own, metres. Thread-safe once read; O(cells).

/// A field with the file that it comes from.
struct MapField {
  enum class Source : std::uint8_t { kDistances, kOccupiedCells };
  std::string path;
  Source source = Source::kDistances;
  DistanceFieldFile file;
  /// Whose folder was named, and checked; a file that is named itself is taken as it is, and so is an older run.
  std::optional<RunReader> run{};
  /// Origin of the kernels' frame in the map, parallel to it: they count in whole cells from there. The
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
