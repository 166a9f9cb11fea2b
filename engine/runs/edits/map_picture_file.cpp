#include "map_picture_file.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/maps/png.hpp"

namespace gdtslam {

void write_map_picture(const std::string& path, const OccupancyMap& map) {
  using Rgba = std::array<std::uint8_t, 4>;
  constexpr Rgba kClear{205, 205, 205, 0};
  constexpr Rgba kWhite{254, 254, 254, 255};
  constexpr Rgba kBlack{0, 0, 0, 255};
  AtomicFile file(path);
  PngWriter png(static_cast<std::uint32_t>(map.geometry.width), static_cast<std::uint32_t>(map.geometry.height),
                PngWriter::Pixels::kRgba8, [&file](std::span<const std::byte> bytes) { file.write(bytes); });
  std::vector<CellState> states(static_cast<std::size_t>(map.geometry.width));
  std::vector<Rgba> row(states.size());
  for (std::int32_t y = map.geometry.height; y-- > 0;) {
    map.read_row(y, states);
    for (std::size_t x = 0; x < states.size(); ++x) {
      row[x] = states[x] == CellState::kUnknown ? kClear : states[x] == CellState::kFree ? kWhite : kBlack;
    }
    png.add_row(std::as_bytes(std::span(row)));
  }
  png.finish();
  file.commit();
}

}  // namespace gdtslam
