// Shell completions of a value: names, files by their endings, folders, options of the settings. The writer of
// completions (command_tree.hpp) reads them from the option. Most values need only their name: FILE, DIR, LOG, CLOUD
// and the like.
#pragma once

#include <string>
#include <vector>

// The same declaration as in shell/cli.hpp, which this folder does not include.
namespace CLI {  // NOLINT(readability-identifier-naming): CLI11's name
class Option;    // NOLINT(bugprone-forward-declaration-namespace): not gdtslam's
}  // namespace CLI

namespace gdtslam {

/// Several kinds can be offered at once: a preset or a file.
struct Offers {
  std::vector<std::string> words{};    ///< names to choose from
  std::vector<std::string> endings{};  ///< file endings, ".ply"; empty: any file
  bool has_files = false;
  bool has_folders = false;
  bool has_settings = false;  ///< PATH=VALUE of the option table
  [[nodiscard]] bool is_empty() const { return words.empty() && !has_files && !has_folders && !has_settings; }
};

/// Sets the completions; returns the option, so that calls can be chained.
CLI::Option* offer(CLI::Option* option, const Offers& offers);

/// Offers these names in addition to the completions of the value's name.
CLI::Option* offer_words(CLI::Option* option, std::vector<std::string> words);

/// Completions set by offer(), else those of the value's name; none for a flag.
Offers find_offers(CLI::Option& option, const std::string& value_name);

}  // namespace gdtslam
