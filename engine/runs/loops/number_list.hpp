// A line of numbers as text. Thread-safe; linear in the text.
#pragma once

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/io/decimal.hpp"

namespace gdtslam {

/// Finite numbers with blanks, one of the separators or both between two; nothing if the text is anything else.
inline std::optional<std::vector<double>> numbers_in(std::string_view text, std::string_view separators) {
  constexpr std::string_view kBlanks = " \t";
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto is_one_of = [&](std::string_view letters) {
    return at != end && letters.find(*at) != std::string_view::npos;
  };
  const auto skip_blanks = [&] {
    while (is_one_of(kBlanks)) ++at;
  };
  for (skip_blanks(); at != end; skip_blanks()) {
    if (!numbers.empty() && is_one_of(separators)) {
      ++at;
      skip_blanks();
    }
    double value = 0.0;
    const char* const stop = parse_double(at, end, value);
    if (stop == nullptr || !std::isfinite(value)) return std::nullopt;
    numbers.push_back(value);
    at = stop;
    if (at != end && !is_one_of(kBlanks) && !is_one_of(separators)) return std::nullopt;
  }
  return numbers;
}

}  // namespace gdtslam
