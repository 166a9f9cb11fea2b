// The help of a command as a page of text, broken between words at the width of the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "command_tree.hpp"

namespace gdtslam {

/// Characters in a line of help: COLUMNS of the environment, else the width of the terminal on standard output, else
/// 80. At least 40 and at most 100, because longer lines are tiring to read.
std::size_t help_width();

/// Description, usage, arguments, options and commands by group, notes and examples. Only a single word or command line
/// that is longer than `width` exceeds it.
std::string help_page(const CommandText& command, std::size_t width);

/// Breaks the text into lines of at most `width` characters.
std::vector<std::string> wrapped(std::string_view text, std::size_t width);

}  // namespace gdtslam
