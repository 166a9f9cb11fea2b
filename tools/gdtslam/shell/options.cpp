#include "options.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {
namespace {

std::string unit_type_name(Unit unit) {
  switch (unit) {
    case Unit::kMetre:
      return "LENGTH";
    case Unit::kRadian:
      return "ANGLE";
    case Unit::kSecond:
      return "TIME";
    case Unit::kNone:
    case Unit::kCell:
    case Unit::kShare:
      break;
  }
  return "NUMBER";
}

}  // namespace

double quantity_of(const std::string& option, const std::string& text, Unit unit) {
  std::string why;
  const std::optional<double> value = parse_stated_quantity(text, unit, &why);
  if (!value) throw UsageError(option + ": " + why);
  return *value;
}

std::vector<std::string> words_between_commas(const std::string& text) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == ',') {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

CLI::Option* add_quantity_option(CLI::App& command, const std::string& name, double& value, Unit unit,
                                 const QuantityBounds& bounds, const std::string& doc) {
  const auto read = [name, &value, unit, bounds](const std::string& text) {
    const double number = quantity_of(name, text, unit);
    if (number < bounds.least || number > bounds.most) {
      throw UsageError(fmt::format("{}: {} is not between {:g} and {:g} {}", name, text, bounds.least, bounds.most,
                                   unit_symbol(unit)));
    }
    value = number;
  };
  return command.add_option_function<std::string>(name, read, doc)->type_name(unit_type_name(unit));
}

CLI::Validator without_leading_zeros() {
  const auto strip = [](std::string& text) -> std::string {
    const bool is_whole = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
    if (is_whole) text.erase(0, std::min(text.find_first_not_of('0'), text.size() - 1));
    return {};
  };
  return {strip, ""};
}

CLI::Validator whole_number_from(std::uint64_t minimum) {
  const auto find_fault = [minimum](const std::string& text) -> std::string {
    std::uint64_t number = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (code == std::errc{} && end == text.data() + text.size() && number >= minimum) return {};
    return "'" + text + "' is no whole number of at least " + std::to_string(minimum);
  };
  return {find_fault, ""};
}

template <class Count>
CLI::Option* add_count_option(CLI::App& command, const std::string& name, Count& count, std::uint64_t minimum,
                              const std::string& doc) {
  return command.add_option(name, count, doc)
      ->type_name("N")
      ->transform(without_leading_zeros())
      ->check(whole_number_from(minimum));
}
template CLI::Option* add_count_option(CLI::App&, const std::string&, int&, std::uint64_t, const std::string&);
template CLI::Option* add_count_option(CLI::App&, const std::string&, std::uint32_t&, std::uint64_t,
                                       const std::string&);
template CLI::Option* add_count_option(CLI::App&, const std::string&, std::uint64_t&, std::uint64_t,
                                       const std::string&);

}  // namespace gdtslam
