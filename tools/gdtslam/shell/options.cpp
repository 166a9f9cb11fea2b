#include "options.hpp"

#include <fmt/format.h>
#include <CLI/App.hpp>

#include <charconv>
#include <filesystem>
#include <optional>
#include <system_error>

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

void check_written_file(std::string_view option, const std::string& file, const std::vector<std::string>& inputs) {
  if (file.empty()) return;
  std::error_code error;  // what cannot be asked about is no input: reading it fails by itself
  for (const std::string& input : inputs) {
    if (!input.empty() && std::filesystem::equivalent(file, input, error)) {
      throw UsageError(fmt::format("{}: '{}' is what is read; give another file", option, file));
    }
  }
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  const std::filesystem::file_status status = std::filesystem::status(folder, error);
  if (folder.empty() || std::filesystem::is_directory(status)) return;
  throw FileError(file, std::filesystem::exists(status) ? "cannot be created: Not a directory"
                                                        : "cannot be created: there is no folder " + folder.string());
}

CLI::Validator whole_number_from(std::uint64_t minimum) {
  const auto fault_of = [minimum](const std::string& text) -> std::string {
    std::uint64_t number = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (code == std::errc{} && end == text.data() + text.size() && number >= minimum) return {};
    return "'" + text + "' is no whole number of at least " + std::to_string(minimum);
  };
  return {fault_of, ""};
}

template <class Count>
CLI::Option* add_count_option(CLI::App& command, const std::string& name, Count& count, std::uint64_t minimum,
                              const std::string& doc) {
  return command.add_option(name, count, doc)->type_name("N")->check(whole_number_from(minimum));
}
template CLI::Option* add_count_option(CLI::App&, const std::string&, int&, std::uint64_t, const std::string&);
template CLI::Option* add_count_option(CLI::App&, const std::string&, std::uint32_t&, std::uint64_t,
                                       const std::string&);
template CLI::Option* add_count_option(CLI::App&, const std::string&, std::uint64_t&, std::uint64_t,
                                       const std::string&);

}  // namespace gdtslam
