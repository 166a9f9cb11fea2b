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

/// The run folder that a map belongs to: itself, or the folder of its gdt.yaml; none if that is not a run.
std::optional<std::string> find_run_folder(const std::string& map);

/// Fit of scans of the mapped place: mean distances of their points to the map's obstacles.
struct FitLimit {
  /// Source of the limit: an option, the 99 % quantile of the run's own scans, or the size of the map's cells.
  enum class Source : std::uint8_t { kOption, kRun, kResolution };
  double distance_m = 0.0;  ///< limit of a good fit
  Source source = Source::kOption;
  double usual_m = 0.0;  ///< the median
};
/// The limit from the mean distances of the run's own scans in the finished map. Two cells are always a good fit: scans
/// that a map was made of fit it better than others, and rounding to cells in scan and map explains up to two cells.
/// Without scans the usual distance is one cell.
FitLimit make_fit_limit(std::vector<double> own_m, double resolution_m);

// The distance field that scans are searched in: of a run, or of an occupancy map that any program made. Frame: the
// map's own, metres. Thread-safe once read; O(cells).

/// A field and its file.
struct MapField {
  enum class Source : std::uint8_t { kDistances, kOccupiedCells };
  std::string path;
  Source source = Source::kDistances;
  DistanceFieldFile file;
  /// The run, if its folder was given; its files are checked. A file given itself, or an older run, is not checked.
  std::optional<RunReader> run{};
  /// Origin of the kernels' frame in the map, parallel to it. Kernels count in whole cells from there. For a run it is
  /// the map's own origin, which lies on its cells; for an occupancy map, whose origin may lie off its cells and far
  /// away, the field's corner.
  Point2 kernel_origin_m = Point2::Zero();

  /// In the kernels' frame. Valid until this object is moved or destroyed.
  [[nodiscard]] FieldView view() const;
  /// All known cells of the field, with every heading.
  [[nodiscard]] PoseWindow known_window() const;
};

/// Adds a border of the cap two cells wide, as searches and kernels need it. A field that ends inside of a map, such as
/// a tile's, has none. O(cells).
MapField framed(MapField field);

/// True for a folder with a gdt.yaml, or a file whose name fits a map's description.
bool looks_like_map(const std::string& path);

/// True for the description of an occupancy map, even if all of its keys are missing; false for a field, which states
/// its version, and if there is no file. Throws InputError.
bool is_occupancy_map(const std::string& path);

/// `map` is a run folder, its gdt.yaml, or the map.yaml of an occupancy map, whose distances are kept up to
/// `config.truncation_m`. Throws InputError, also if it has no occupied cell; FileError.
MapField read_map_field(const std::string& map, const MapConfig& config);

/// The map to draw: the occupancy map of the run or file, else walls made from the distances.
OccupancyMap shown_map(const MapField& field);

}  // namespace gdtslam
