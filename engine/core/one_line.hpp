// Text from outside within messages: one line, printable, short. Thread-safe.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gdtslam {

/// The text with '?' for everything that is no printable ASCII; cut at `limit` characters.
std::string one_line(std::string_view text, std::size_t limit = 200);

}  // namespace gdtslam
