#include "roff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "tools/gdtslam/shell/help/help_page.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kLineWidth = 78;  // mandoc calls longer lines bad style

std::string upper(std::string_view text) {
  std::string large(text);
  std::transform(large.begin(), large.end(), large.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return large;
}

// A line that begins with one of these would be an order to the formatter.
std::string as_line(const std::string& line) {
  return line.starts_with('.') || line.starts_with('\'') ? "\\&" + line : line;
}

}  // namespace

std::string plain(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '\\':
        escaped += "\\e";
        break;
      case '-':  // else a hyphen, which cannot be copied into a shell
        escaped += "\\-";
        break;
      case '\'':
        escaped += "\\(aq";
        break;
      case '`':
        escaped += "\\(ga";
        break;
      case '^':
        escaped += "\\(ha";
        break;
      case '~':
        escaped += "\\(ti";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string bold(std::string_view text) { return "\\fB" + plain(text) + "\\fR"; }
std::string italic(std::string_view text) { return "\\fI" + plain(text) + "\\fR"; }

RoffPage::RoffPage(std::string_view name, int section, const PageStamp& stamp, std::string_view title)
    : text_(
          fmt::format(".\\\" Made by 'gdtslam generate man'.\n.TH {} {} \"{}\" \"gdtslam {}\" \"Manual of gdtslam\"\n",
                      upper(name), section, stamp.date, stamp.version)) {
  // No word is broken and no line is stretched: names of options stay whole.
  text_ += ".nh\n.ad l\n.SH NAME\n";
  add_text(plain(name) + " \\- " + plain(title));
}

void RoffPage::section(std::string_view heading) { text_ += ".SH " + upper(heading) + "\n"; }

void RoffPage::subsection(std::string_view heading) { text_ += ".SS " + std::string(heading) + "\n"; }

void RoffPage::paragraph(const std::string& text) {
  // mandoc: .PP behind a heading does nothing.
  const std::size_t last = text_.rfind('\n', text_.size() - 2) + 1;
  if (!text_.substr(last).starts_with(".S")) text_ += ".PP\n";
  add_text(text);
}

void RoffPage::item(const std::string& tag, const std::string& text) {
  text_ += ".TP\n" + as_line(tag) + "\n";
  add_text(text);
}

void RoffPage::code(const std::vector<std::string>& lines) {
  const std::size_t last = text_.rfind('\n', text_.size() - 2) + 1;
  if (!text_.substr(last).starts_with(".S")) text_ += ".PP\n";
  text_ += ".nf\n.RS 2\n";
  for (const std::string& line : lines) text_ += as_line(plain(line)) + "\n";
  text_ += ".RE\n.fi\n";
}

void RoffPage::add_text(const std::string& text) {
  for (const std::string& line : wrapped(text, kLineWidth)) text_ += as_line(line) + "\n";
}

}  // namespace gdtslam
