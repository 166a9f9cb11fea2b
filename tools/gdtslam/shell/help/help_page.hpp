// The help of a command as a page of text, broken between words at the width of the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "command_tree.hpp"

namespace gdtslam {

/// Letters of a line of help: COLUMNS of the environment, else the width of the terminal that standard output is, else
/// 80; at least 40 and at most 100, beyond which lines are tiring to read.
std::size_t help_width();

/// Description, usage, arguments, options and commands by group, notes and examples. Only a word or a command line that
/// is longer than a line by itself goes beyond `width`.
std::string help_page(const CommandText& command, std::size_t width);

/// The words of the text in lines of at most `width` letters.
std::vector<std::string> wrapped(std::string_view text, std::size_t width);

}  // namespace gdtslam
