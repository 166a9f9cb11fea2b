// Grey pictures as PGM (P5, one byte a pixel). Thread-safe; O(pixels). The stated size must be the file's: no memory is
// taken on a header's word.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace gdtslam {

/// Rows from the top.
struct Grey8Image {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t max_value = 255;  ///< the level that means white
  std::vector<std::uint8_t> pixels;
};

/// Throws InputError.
Grey8Image decode_pgm(std::span<const std::byte> data, const std::string& name);

}  // namespace gdtslam
