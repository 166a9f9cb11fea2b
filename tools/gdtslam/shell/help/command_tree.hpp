// The commands, arguments and options of the command line as plain texts: what the help and the completions of
// shells are made of, so that none of them says anything else than the others.
#pragma once

#include <string>
#include <vector>

#include "offers.hpp"

// The same declaration as in shell/cli.hpp, which this folder does not know.
namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class App;
}  // namespace CLI

namespace gdtslam {

/// Commands of this group are listed in the help with the reason why this build cannot run them, and nowhere else.
inline constexpr const char* kMissingCommands = "Not in this build";

struct OptionText {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument "log"
  std::string value;               ///< "DIR"; empty for a flag
  std::string doc;                 ///< one paragraph without its default
  std::string default_text;        ///< value if it is not given; empty if there is none
  std::string bounds;              ///< "1 to 100"; empty where it has none
  std::vector<std::string> needs;  ///< names of what it counts with only
  bool is_required = false;
  bool repeats = false;  ///< may be given several times
  Offers offers{};       ///< completions of its value
};

struct OptionGroup {
  std::string title;
  std::vector<OptionText> options;
};

/// Text of a footer: a paragraph, and lines that stay as they are after it.
struct Paragraph {
  std::string text;
  std::vector<std::string> lines;
};

struct CommandText {
  std::string path;   ///< "gdtslam config show"
  std::string name;   ///< "show"
  std::string doc;    ///< its line in the list of commands
  std::string group;  ///< under which it stands there
  std::vector<OptionText> arguments;
  std::vector<OptionGroup> groups;
  std::vector<CommandText> commands;
  std::vector<Paragraph> notes;       ///< paragraphs before the examples
  std::vector<std::string> examples;  ///< lines
  std::vector<Paragraph> end_notes;   ///< paragraphs behind the examples
};

/// A command and all below it. Hidden options and commands are left out. A text of an option may end with what counts
/// when it is not given, "(default: the log's)" or "[the log's]", where that is no value that the parser could show.
CommandText command_text(CLI::App& app);

/// "default: 1; 1 to 100; required; with --design": all that is behind an option's sentence; empty where nothing is.
std::string option_facts(const OptionText& option);

}  // namespace gdtslam
