// What a shell offers where a value is typed: names, files by their endings, folders, options of the settings. An
// option carries it from where it is declared to whoever writes completions (command_tree.hpp). Most say it by the name
// of their value already: FILE, DIR, LOG, CLOUD and the like need no word here.
#pragma once

#include <string>
#include <vector>

// As in shell/cli.hpp, which this room does not know.
namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class Option;    // NOLINT(bugprone-forward-declaration-namespace): not gdtslam's
}  // namespace CLI

namespace gdtslam {

/// All kinds at once may be offered: a preset or a file.
struct Offers {
  std::vector<std::string> words{};    ///< names to choose from
  std::vector<std::string> endings{};  ///< of the files that are offered, ".ply"; none: any file
  bool has_files = false;
  bool has_folders = false;
  bool has_settings = false;  ///< PATH=VALUE of the option table
  [[nodiscard]] bool is_empty() const { return words.empty() && !has_files && !has_folders && !has_settings; }
};

/// Returns the option, so that calls can be chained.
CLI::Option* offer(CLI::Option* option, const Offers& offers);

/// These names, beside what the name of its value says.
CLI::Option* offer_words(CLI::Option* option, std::vector<std::string> words);

/// What was stated by offer(), else what the name of its value says; nothing for a flag.
Offers offers_of(CLI::Option& option, const std::string& value_name);

}  // namespace gdtslam
