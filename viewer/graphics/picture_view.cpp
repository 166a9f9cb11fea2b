#include "picture_view.hpp"

#include <algorithm>

namespace gdtslam {
std::vector<PictureBand> bands_of(std::uint32_t width, std::uint32_t height, const BandShape& shape) {
  const auto& [samples, margin, most_pixels] = shape;
  if (width * std::uint64_t{height} <= most_pixels) return {{0, height, 0, height}};
  // At least as many rows are kept as are drawn for their sake alone.
  const std::uint32_t wanted = std::max(most_pixels / width, 4 * margin + samples);
  const std::uint32_t kept = std::max((wanted - std::min(wanted, 2 * margin)) / samples, 1U) * samples;
  const std::uint32_t rows = std::min(height, kept + 2 * margin);
  std::vector<PictureBand> bands;
  bands.reserve(height / kept + 1);
  for (std::uint32_t row = 0; row < height; row += kept) {
    const std::uint32_t first = std::min(row - std::min(row, margin), height - rows);
    bands.push_back({first, rows, row, std::min(kept, height - row)});
  }
  return bands;
}

}  // namespace gdtslam
