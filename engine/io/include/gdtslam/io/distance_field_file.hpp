// The GDT as a picture that keeps every bit: gdt.png (16-bit grey, top row = highest y) with gdt.yaml
// (docs/formats.md). Values are in 1/256 cell; the cap means "this far or farther, or unknown". The picture holds value
// times a whole scale, the largest that fits, so that it can be looked at. Thread-safe; O(cells).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gdtslam/core/grids.hpp"

namespace gdtslam {

/// Writes the YAML at `yaml_path` and the PNG beside it (the same stem), the YAML last. Throws FileError;
/// InputError when the field has no cells, its cap is 0 or a value lies above the cap.
void write_distance_field(const std::string& yaml_path, const DistanceFieldRows& field);

/// A distance field read from a file; stride = width.
struct DistanceFieldFile {
  GridGeometry geometry;
  std::vector<std::uint16_t> cells;
  std::uint16_t cap = 0;
  [[nodiscard]] DistanceFieldView view() const {
    return {geometry, static_cast<std::size_t>(geometry.width), cells, cap};
  }
};
/// Throws InputError or FileError.
DistanceFieldFile read_distance_field(const std::string& yaml_path);

}  // namespace gdtslam
