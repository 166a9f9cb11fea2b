// Words as letters: UTF-8 taken apart, broken bytes replaced. Names come from logs and files of others, so none is
// trusted. Thread-safe; O(bytes).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gdtslam {

inline constexpr char32_t kUnknownLetter = 0xFFFD;
inline constexpr std::string_view kUnknownLetterBytes = "\xEF\xBF\xBD";

struct Letter {
  char32_t code = kUnknownLetter;  ///< also where the bytes are no UTF-8: one for each longest beginning of a letter
  std::string_view bytes;          ///< the same bytes as in the words
};
/// The letter that begins at byte `at`, which moves to the next one; `at` < words.size().
Letter next_letter(std::string_view words, std::size_t& at);

/// Whether the words are UTF-8 from end to end.
bool is_utf8(std::string_view words);

/// The words as pictures and pages can hold them: valid UTF-8 of one line; control characters become spaces, broken
/// bytes U+FFFD.
std::string legible(std::string_view words);

/// Legible words with & < > " ' as references: for text of HTML and SVG and for attributes in either kind of quotes.
std::string markup_text(std::string_view text);

/// Cut to a width in pixels, with three dots where letters are missing.
std::string shortened(const std::string& words, double size, double room, bool is_bold = false);

/// Cut in the middle instead, because names of runs often differ at their ends only. The last `kept` bytes, a remark
/// about the name, stay whole if they leave the name a third of the room; otherwise they go.
std::string shortened_within(const std::string& words, double size, double room, std::size_t kept = 0);

}  // namespace gdtslam
