// Digits and letters of ASCII, independent of the locale. Thread-safe; linear.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

/// True for at least one digit and nothing else.
inline bool is_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

/// The text with A to Z in lower case.
inline std::string in_small_letters(std::string_view text) {
  std::string small(text);
  for (char& c : small) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return small;
}

}  // namespace gdtslam
