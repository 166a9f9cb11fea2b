// The commands, arguments and options of the command line as plain text: one source for the help and the shell
// completions.
#pragma once

#include <string>
#include <vector>

#include "offers.hpp"

// The same declaration as in shell/cli.hpp, which this folder does not include.
namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class App;
}  // namespace CLI

namespace gdtslam {

/// Group of commands missing from this build. The help lists them with the reason; nothing else does.
inline constexpr const char* kMissingCommands = "Not in this build";

struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument "log"
  std::string value;               ///< "DIR"; empty for a flag
  std::string doc;                 ///< one paragraph without its default
  std::string default_text;        ///< default value; empty if there is none
  std::string bounds;              ///< "1 to 100"; empty if there are none
  std::vector<std::string> needs;  ///< names of options that it requires
  bool is_required = false;
  bool repeats = false;  ///< may be given several times
  Offers offers{};       ///< completions of its value
};

struct OptionGroup {
  std::string title;
  std::vector<OptionText> options;
};

/// Part of a footer: a paragraph, or lines that are kept unchanged.
struct Paragraph {
  std::string text;
  std::vector<std::string> lines;
};

struct CommandText {
  std::string path;   ///< "gdtslam config show"
  std::string name;   ///< "show"
  std::string doc;    ///< line in the list of commands
  std::string group;  ///< heading in the list of commands
  std::vector<OptionText> arguments;
  std::vector<OptionGroup> groups;
  std::vector<CommandText> commands;
  std::vector<Paragraph> notes;       ///< paragraphs before the examples
  std::vector<std::string> examples;  ///< lines
  std::vector<Paragraph> end_notes;   ///< paragraphs after the examples
};

/// A command and all below it, without hidden options and commands. An option's text may end with a default that the
/// parser cannot show, "(default: the log's)" or "[the log's]".
CommandText command_text(CLI::App& app);

/// Remarks after an option's sentence, "default: 1; 1 to 100; required; with --design"; empty if there are none.
std::string option_facts(const OptionText& option);

}  // namespace gdtslam
