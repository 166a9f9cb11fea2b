// Options that are counts. CLI11 alone takes "-1" for an unsigned number and wraps it. Thread-safe.
#pragma once

#include <CLI/App.hpp>
#include <charconv>
#include <cstdint>
#include <string>

namespace gdtslam {

/// Accepts whole decimal numbers of at least `minimum` that fit 64 bits.
inline CLI::Validator whole_number_from(std::uint64_t minimum) {
  const auto fault_of = [minimum](const std::string& text) -> std::string {
    std::uint64_t number = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (code == std::errc{} && end == text.data() + text.size() && number >= minimum) return {};
    return "'" + text + "' is no whole number of at least " + std::to_string(minimum);
  };
  return {fault_of, ""};
}

/// An option that is a count of at least `minimum`.
template <class Count>
CLI::Option* add_count_option(CLI::App& command, const std::string& name, Count& count, std::uint64_t minimum,
                              const std::string& doc) {
  return command.add_option(name, count, doc)->type_name("N")->check(whole_number_from(minimum));
}

}  // namespace gdtslam
