// The manual: a page for the command and for each of its commands, from the tree that the help is made of, one for the
// options of the settings, from their table, and one for the files of a run.
#pragma once

#include <string>
#include <vector>

#include "roff.hpp"
#include "tools/gdtslam/shell/help/command_tree.hpp"

namespace gdtslam {

struct ManPage {
  std::string name;  ///< "gdtslam-map"
  int section = 1;
  std::string text;
  [[nodiscard]] std::string file() const { return name + "." + std::to_string(section); }
};

/// All of them, gdtslam(1) first, commands before those below them.
std::vector<ManPage> man_pages(const CommandText& root, const PageStamp& stamp);

// Parts of it, each in a source of its own.
ManPage options_page(const PageStamp& stamp);
ManPage formats_page(const PageStamp& stamp);

}  // namespace gdtslam
