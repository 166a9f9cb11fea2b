#include "letters.hpp"

#include <cstdint>

namespace gdtslam {
namespace {

std::size_t length_of(std::uint8_t lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead < 0xE0) return 2;
  if (lead >= 0xE0 && lead < 0xF0) return 3;
  if (lead >= 0xF0 && lead < 0xF5) return 4;
  return 0;
}

bool is_valid(char32_t code, std::size_t length) {
  const bool is_overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  return !is_overlong && code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
}

}  // namespace

Letter next_letter(std::string_view words, std::size_t& at) {
  const std::size_t begin = at;
  ++at;  // past one byte where it begins no letter
  const auto lead = static_cast<std::uint8_t>(words[begin]);
  const std::size_t length = length_of(lead);
  const Letter wrong{0xFFFD, words.substr(begin, 1)};
  if (length == 0 || begin + length > words.size()) return wrong;
  char32_t code = length == 1 ? lead : lead & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    const auto next = static_cast<std::uint8_t>(words[begin + i]);
    if ((next & 0xC0U) != 0x80U) return wrong;
    code = code << 6U | (next & 0x3FU);
  }
  if (!is_valid(code, length)) return wrong;
  at = begin + length;
  return {code, words.substr(begin, length)};
}

std::string legible(std::string_view words) {
  std::string result;
  for (std::size_t at = 0; at < words.size();) {
    const Letter letter = next_letter(words, at);
    if (letter.code < 0x20 || (letter.code >= 0x7F && letter.code < 0xA0)) {
      result += ' ';
    } else if (letter.code >= 0xFFFD && letter.code <= 0xFFFF) {  // the last two are no characters
      result += "\xEF\xBF\xBD";
    } else {
      result += letter.bytes;
    }
  }
  return result;
}

}  // namespace gdtslam
