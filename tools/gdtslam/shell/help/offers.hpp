// Completions that a shell offers for a value: names, files by their endings, folders, options of the settings. An
// option carries them from its declaration to the writer of completions (command_tree.hpp). The name of the value is
// enough for most: FILE, DIR, LOG, CLOUD and the like.
#pragma once

#include <string>
#include <vector>

// The same declaration as in shell/cli.hpp, which this folder does not know.
namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class Option;    // NOLINT(bugprone-forward-declaration-namespace): not gdtslam's
}  // namespace CLI

namespace gdtslam {

/// All kinds at once may be offered: a preset or a file.
struct Offers {
  std::vector<std::string> words{};    ///< names to choose from
  std::vector<std::string> endings{};  ///< endings of the files that are offered, ".ply"; none: any file
  bool has_files = false;
  bool has_folders = false;
  bool has_settings = false;  ///< PATH=VALUE of the option table
  [[nodiscard]] bool is_empty() const { return words.empty() && !has_files && !has_folders && !has_settings; }
};

/// Returns the option, so that calls can be chained.
CLI::Option* offer(CLI::Option* option, const Offers& offers);

/// These names, beside what the name of its value says.
CLI::Option* offer_words(CLI::Option* option, std::vector<std::string> words);

/// The completions stated by offer(), else those of the name of its value; none for a flag.
Offers find_offers(CLI::Option& option, const std::string& value_name);

}  // namespace gdtslam
