// What every picture of a field relies on. Constant time.
#pragma once

#include <string>

#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/map_picture.hpp"

namespace gdtslam::picture {

/// Throws InputError where cells are missing or the cap says nothing.
inline void check(const FieldPicture& field) {
  const GridGeometry& geometry = field.geometry;
  if (geometry.width < 1 || geometry.height < 1 || field.cells.size() != geometry.cell_count()) {
    throw InputError("the distance field has " + std::to_string(field.cells.size()) + " values for " +
                     std::to_string(geometry.width) + " x " + std::to_string(geometry.height) + " cells");
  }
  if (field.cap == 0) throw InputError("the distance field has cap 0: no cell could be known");
}

}  // namespace gdtslam::picture
