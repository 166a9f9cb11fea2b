// Completions of the command line for three shells, from the tree that the help is made of and the table of the
// options: commands, options and values. Each is one text that the shell reads; nothing of gdtslam runs when a key is
// pressed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/gdtslam/shell/help/command_tree.hpp"
#include "tools/gdtslam/shell/help/option_rows.hpp"

namespace gdtslam {

/// What --set PATH=VALUE offers.
using SettingRows = std::vector<OptionRow>;

std::string bash_completion(const CommandText& root, const SettingRows& settings);
std::string zsh_completion(const CommandText& root, const SettingRows& settings);
std::string fish_completion(const CommandText& root, const SettingRows& settings);

// What the three have in common.

/// The command and all below it that this build has, in the order of the help.
std::vector<const CommandText*> commands_from(const CommandText& root);

/// All options of a command, of every group.
std::vector<const OptionText*> options_in(const CommandText& command);

/// What may stand where no option asks for a value: all that its arguments are.
Offers offers_of_arguments(const CommandText& command);

/// In single quotes of a POSIX shell.
std::string quoted_for_shell(std::string_view text);

/// The words, each behind a blank but the first.
std::string spaced(const std::vector<std::string>& words);

}  // namespace gdtslam
