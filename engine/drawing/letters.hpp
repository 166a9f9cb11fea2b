// Splits UTF-8 words into letters and replaces invalid bytes. Names from logs and files are untrusted. Thread-safe;
// O(bytes).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gdtslam {

inline constexpr char32_t kUnknownLetter = 0xFFFD;
inline constexpr std::string_view kUnknownLetterBytes = "\xEF\xBF\xBD";

struct Letter {
  char32_t code = kUnknownLetter;  ///< also for invalid UTF-8: one for each longest valid prefix of a letter
  std::string_view bytes;          ///< the same bytes as in the words
};
/// Returns the letter at byte `at`, and moves `at` to the next one; `at` < words.size().
Letter next_letter(std::string_view words, std::size_t& at);

/// Whether all the words are valid UTF-8.
bool is_utf8(std::string_view words);

/// Text that pictures and pages can show: one line of valid UTF-8; control characters become spaces, invalid bytes
/// U+FFFD.
std::string legible(std::string_view words);

/// Legible words with & < > " ' as references: for text of HTML and SVG and for attributes in either kind of quotes.
std::string markup_text(std::string_view text);

/// Shortens words to a width in pixels, with three dots for the missing letters.
std::string shortened(const std::string& words, double size, double room, bool is_bold = false);

/// Shortens in the middle instead, because names of runs often differ only at the end. The last `kept` bytes, a remark
/// on the name, stay whole if the name keeps a third of the room; otherwise they are dropped.
std::string shortened_within(const std::string& words, double size, double room, std::size_t kept = 0);

}  // namespace gdtslam
