// A manual page in the language of man(7), for groff and mandoc. Texts are escaped here; a page is the same bytes
// whenever and wherever it is made.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gdtslam {

/// What stands at the head and foot of each page.
struct PageStamp {
  std::string version;  ///< of gdtslam
  std::string date;     ///< YYYY-MM-DD; may be empty
};

/// "\fB-o\fR" and "\fIFILE\fR": a text in bold and in italics, escaped.
std::string bold(std::string_view text);
std::string italic(std::string_view text);
/// As it is.
std::string plain(std::string_view text);

class RoffPage {
 public:
  /// `name` as it is called ("gdtslam-map"), `section` of the manual (1, 5), `title` what it is, in a line.
  RoffPage(std::string_view name, int section, const PageStamp& stamp, std::string_view title);

  void section(std::string_view heading);
  void subsection(std::string_view heading);
  /// `text` is escaped already, of plain(), bold() and italic().
  void paragraph(const std::string& text);
  /// A tag and what it means, both escaped already.
  void item(const std::string& tag, const std::string& text);
  /// Lines that stay as they are; not escaped yet.
  void code(const std::vector<std::string>& lines);

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add_text(const std::string& text);
  std::string text_;
};

}  // namespace gdtslam
