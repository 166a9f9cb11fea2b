#include "quantity_option.hpp"

#include <CLI/App.hpp>
#include <fmt/format.h>

#include "engine/core/stated_quantity.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

std::string type_name_of(Unit unit) {
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
  return command.add_option_function<std::string>(name, read, doc)->type_name(type_name_of(unit));
}

}  // namespace gdtslam
