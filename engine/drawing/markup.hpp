// Words on their way into markup: HTML, SVG and XML. Names come from logs and files of others, so none is trusted: it
// may hold markup, control characters or bytes that are no UTF-8. Thread-safe; O(length).
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// Valid UTF-8 of characters that HTML and XML allow. U+FFFD stands for what is no UTF-8, as browsers do it, for
/// control characters save line breaks and tabs, and for U+FFFE and U+FFFF (XML 1.0, production 2).
std::string clean_utf8(std::string_view text);
/// clean_utf8 with & < > " ' as references: for text and for attributes in either kind of quotes.
std::string markup_text(std::string_view text);

}  // namespace gdtslam
