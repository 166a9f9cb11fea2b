// The compression of PCD's binary_compressed, LibLZF's format. Linear; thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace gdtslam {

/// The unpacked bytes; nothing when the input is damaged or does not give exactly `size` bytes, for which it takes
/// the memory at once: at most 88 times those packed make sense.
std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size);

}  // namespace gdtslam
