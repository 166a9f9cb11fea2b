// Bytes as base64, with padding [Josefsson2006]. Thread-safe; O(bytes).
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace gdtslam {

/// Appends to a text. Pieces give the text of the whole if all lengths but the last are multiples of three.
void append_base64(std::span<const std::byte> bytes, std::string& out);

}  // namespace gdtslam
