// The rules that hold for the text of every source file: who may include whom, what no library does, what a file looks
// like. Pure functions from a path (relative to the project, with '/') and its text to the violations, so that each
// rule can be shown a text that breaks it.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gdtslam::architecture {

/// One line that breaks a rule.
struct Violation {
  std::size_t line = 0;  ///< from 1; 0 when the file as a whole is meant
  std::string message;
};

/// The part that a path belongs to: "core" for engine/core/..., "calib", "viewer", "shaders", "tools", "examples",
/// "tests"; empty outside.
std::string part_of(std::string_view path);
/// The same text with comments, and the contents of strings and characters, as blanks; line breaks stay.
std::string without_comments_and_literals(std::string_view text);

/// Who may include whom: parts of the project, third-party libraries, nothing private of another part.
std::vector<Violation> include_violations(std::string_view path, std::string_view text);
/// A library does not print; tools do.
std::vector<Violation> printing_violations(std::string_view path, std::string_view text);
/// Nothing that differs between hosts or standard libraries where results are made: no libm, no std:: random numbers.
std::vector<Violation> determinism_violations(std::string_view path, std::string_view text);
/// Length, tabs, trailing spaces, the last line break, words that mark unfinished work.
std::vector<Violation> form_violations(std::string_view path, std::string_view text);
/// A public header says what it is and may be included twice.
std::vector<Violation> header_violations(std::string_view path, std::string_view text);

/// The keys of a BibTeX file.
std::set<std::string> bibliography_keys(std::string_view bibtex);
/// Citations such as [Meijster2000] whose key the bibliography lacks.
std::vector<Violation> citation_violations(std::string_view text, const std::set<std::string>& keys);
/// The targets of relative Markdown links, without their anchors, in order.
std::vector<std::string> relative_links(std::string_view markdown);

/// A name in code style that a document puts right behind a link, as in [file](path) `one`, `two`.
struct NameInFile {
  std::string link;
  std::string name;
};
std::vector<NameInFile> names_behind_links(std::string_view markdown);

}  // namespace gdtslam::architecture
