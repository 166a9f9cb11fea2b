// Bytes as base64, with padding [Josefsson2006]. Thread-safe; O(bytes).
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace gdtslam {

/// At the end of a text. Pieces whose lengths are multiples of three, but for the last, give the text of the whole.
void append_base64(std::span<const std::byte> bytes, std::string& out);

}  // namespace gdtslam
