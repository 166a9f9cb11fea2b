// Completions of the command line for bash and zsh. Their scripts ask the program, which answers from the tree that the
// help is made of and the table of the options.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/gdtslam/shell/help/command_tree.hpp"
#include "tools/gdtslam/shell/help/option_rows.hpp"

namespace gdtslam {

/// The script of a shell; empty if the shell is neither bash nor zsh.
std::string_view completion_script(std::string_view shell);

/// Completions of the last of the words behind the program's name, which is being typed: whole words, a line each.
/// Lines ":files .ply .pcd" (":files" for any) and ":folders" stand for names that the shell finds itself.
std::string offers_behind(const CommandText& root, const std::vector<std::string>& words,
                          const std::vector<OptionRow>& settings);

}  // namespace gdtslam
