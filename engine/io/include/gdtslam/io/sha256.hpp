// SHA-256 [FIPS2015], to say in one line that two results are the same bytes. Not thread-safe; O(n), no allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/distance_field_file.hpp"

namespace gdtslam {

class Sha256 {
 public:
  Sha256& update(std::span<const std::byte> data);
  Sha256& update(std::string_view text);
  /// Numbers as little-endian bytes, whatever the host.
  Sha256& update(double value);
  Sha256& update(std::int32_t value);
  Sha256& update(std::uint16_t value);
  /// 64 hexadecimal digits; the object can be used no further.
  std::string hex();

 private:
  void process_blocks(const std::uint8_t* blocks, std::size_t count);

  std::array<std::uint32_t, 8> state_{0x6a09e667U, 0xbb67ae85U, 0x3c6ef372U, 0xa54ff53aU,
                                      0x510e527fU, 0x9b05688cU, 0x1f83d9abU, 0x5be0cd19U};
  std::array<std::uint8_t, 64> block_{};
  std::size_t block_size_ = 0;
  std::uint64_t total_bytes_ = 0;
};

/// Of the GDT: resolution, origin x and y (doubles), width and height (int32), then its cells row by row (uint16),
/// without the padding of the rows; all little-endian.
std::string sha256_of(const DistanceFieldView& field);
/// Of the poses: x, y and theta of each (doubles, little-endian).
std::string sha256_of(const Trajectory& trajectory);

}  // namespace gdtslam
