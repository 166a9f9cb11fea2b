#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <variant>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "yaml_file.hpp"
#include "yaml_text.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kVersionKey = "version";
constexpr std::string_view kVersion = "1";
constexpr std::size_t kMaxFaults = 20;

/// A value that fits its option but is not stored yet.
struct ParsedValue {
  std::variant<double, std::int32_t, bool, std::string_view>
      value;  ///< in the order of Option::value; a name of a Choice
};

/// Whether a length, an angle or a time may be a bare number, in metres, radians or seconds.
enum class BareNumber { kAllowed, kRefused };

[[noreturn]] void refuse(const Option& option, std::string_view text, const std::string& reason) {
  throw std::invalid_argument(fmt::format("{}: {} {}", option.path, in_quotes(text), reason));
}

// A bound may also be given as shown in messages, with six digits of a degree; then it stands for the exact bound.
double within_told_bounds(const Option& option, double value) {
  for (const double bound : {option.min, option.max}) {
    if (show_quantity(value, option.unit) == show_quantity(bound, option.unit)) {
      return std::clamp(value, option.min, option.max);
    }
  }
  return value;
}

double parse_number(const Option& option, std::string_view text, BareNumber bare) {
  std::string why;
  const std::optional<double> value = bare == BareNumber::kRefused ? parse_stated_quantity(text, option.unit, &why)
                                                                   : parse_quantity(text, option.unit, &why);
  if (!value) {
    refuse(option, text, fmt::format("is no value of it: {}", why));
  }
  const double number = within_told_bounds(option, *value);
  if (number < option.min) {
    refuse(option, text, fmt::format("is below its minimum {}", show_quantity(option.min, option.unit)));
  }
  if (number > option.max) {
    refuse(option, text, fmt::format("is above its maximum {}", show_quantity(option.max, option.unit)));
  }
  return number;
}

std::int32_t parse_whole(const Option& option, std::string_view text, BareNumber bare) {
  const double value = parse_number(option, text, bare);
  if (value != std::floor(value) || std::fabs(value) > 2147483647.0) {
    refuse(option, text, "is no whole number");
  }
  return static_cast<std::int32_t>(value);
}

bool parse_bool(const Option& option, std::string_view text) {
  if (text != "true" && text != "false") {
    refuse(option, text, "is neither true nor false");
  }
  return text == "true";
}

std::string_view parse_choice(const Option& option, const Choice& choice, std::string_view text) {
  const auto names = choice.names();
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) {
    return *found;
  }
  const std::optional<std::string_view> nearest = nearest_name(text, names);
  refuse(option, text,
         fmt::format("is none of {}{}", fmt::join(names, ", "),
                     nearest ? fmt::format("; did you mean {}?", *nearest) : std::string()));
}

/// Throws std::invalid_argument with "path: value: fault".
ParsedValue parse_option_value(const Option& option, std::string_view text, BareNumber bare) {
  switch (option.value.index()) {
    case 0:
      return {parse_number(option, text, bare)};
    case 1:
      return {parse_whole(option, text, bare)};
    case 2:
      return {parse_bool(option, text)};
    default:
      return {parse_choice(option, std::get<Choice>(option.value), text)};
  }
}

void store(const Option& option, const ParsedValue& parsed) {
  switch (option.value.index()) {
    case 0:
      *std::get<double*>(option.value) = std::get<double>(parsed.value);
      break;
    case 1:
      *std::get<std::int32_t*>(option.value) = std::get<std::int32_t>(parsed.value);
      break;
    case 2:
      *std::get<bool*>(option.value) = std::get<bool>(parsed.value);
      break;
    default:
      std::get<Choice>(option.value).set(std::get<std::string_view>(parsed.value));
  }
}

std::string unknown_name(const std::string& path, std::span<const Option> options) {
  std::vector<std::string_view> names;
  for (const Option& option : options) {
    names.push_back(option.path);
  }
  const std::optional<std::string_view> nearest = nearest_name(path, names);
  return nearest ? fmt::format("unknown option {}; did you mean {}?", in_quotes(path), *nearest)
                 : fmt::format("unknown option {}; `gdtslam config show --all` lists all", in_quotes(path));
}

// Names the section that an unknown one resembles.
std::string unknown_section(const std::string& path, std::span<const Option> options) {
  std::vector<std::string_view> sections;
  for (const Option& option : options) {
    const std::size_t end = option.path.find('.');
    if (end != std::string_view::npos) sections.push_back(option.path.substr(0, end));
  }
  const std::optional<std::string_view> nearest = nearest_name(path, sections);
  return nearest ? fmt::format("unknown option {}; did you mean the section {}?", in_quotes(path), *nearest)
                 : unknown_name(path, options);
}

/// Walks a document, collects values and faults; changes nothing if there is a fault.
class ConfigDocument {
 public:
  ConfigDocument(const std::string& name, std::span<const Option> options) : name_(name), options_(options) {}

  void visit(const YAML::Node& node, const std::string& section) {
    for (const auto& entry : node) {
      if (!entry.first.IsScalar()) {
        add_fault(entry.first, "a name must be a plain word");
        continue;
      }
      const std::string path = section.empty() ? entry.first.Scalar() : section + "." + entry.first.Scalar();
      if (std::find(seen_.begin(), seen_.end(), path) != seen_.end()) {
        add_fault(entry.first, fmt::format("{} is given twice", in_quotes(path)));
        continue;
      }
      visit_entry(entry.first, entry.second, path);
    }
  }

  std::vector<std::string> apply() {
    if (!faults_.empty()) {
      if (faults_not_told_ > 0) faults_.push_back(fmt::format("and {} more", faults_not_told_));
      throw ConfigError(fmt::format("{}", fmt::join(faults_, "; ")));
    }
    std::vector<std::string> paths;
    for (const auto& [option, value] : values_) {
      store(*option, value);
      paths.emplace_back(option->path);
    }
    return paths;
  }

  void add_fault(const YAML::Node& where, const std::string& message) {
    if (has_room()) {
      faults_.push_back(located({name_, find_line(where)}, message));
    } else {
      ++faults_not_told_;
    }
  }

 private:
  void visit_entry(const YAML::Node& key, const YAML::Node& value, const std::string& path) {
    if (path == kVersionKey) {
      seen_.push_back(path);
      if (!value.IsScalar() || value.Scalar() != kVersion) {
        add_fault(key, fmt::format("version: this program reads version {}", kVersion));
      }
      return;
    }
    const Option* const option = find(path);
    if (option != nullptr) {
      seen_.push_back(path);
      visit_value(*option, key, value);
    } else if (is_section(path)) {
      seen_.push_back(path);
      if (value.IsMap()) {
        visit(value, path);
      } else if (!value.IsNull()) {
        add_fault(key, fmt::format("{} is a section; write its options indented below it", path));
      }
    } else {
      const auto unknown = value.IsMap() ? unknown_section : unknown_name;
      add_fault(key, has_room() ? unknown(path, options_) : std::string());
    }
  }

  void visit_value(const Option& option, const YAML::Node& key, const YAML::Node& value) {
    if (!value.IsScalar()) {
      add_fault(key, fmt::format("{}: must be a single value", option.path));
      return;
    }
    try {
      values_.emplace_back(&option, parse_option_value(option, value.Scalar(), BareNumber::kAllowed));
    } catch (const std::invalid_argument& error) {
      add_fault(value, error.what());
    }
  }

  // A file may have a hundred thousand faults; only the first are listed, the others are counted.
  [[nodiscard]] bool has_room() const { return faults_.size() < kMaxFaults; }

  [[nodiscard]] const Option* find(std::string_view path) const {
    const auto found =
        std::find_if(options_.begin(), options_.end(), [&](const Option& option) { return option.path == path; });
    return found == options_.end() ? nullptr : &*found;
  }
  [[nodiscard]] bool is_section(const std::string& path) const {
    return std::any_of(options_.begin(), options_.end(),
                       [&](const Option& option) { return option.path.starts_with(path + "."); });
  }

  const std::string& name_;
  std::span<const Option> options_;
  std::vector<std::string> seen_;
  std::vector<std::string> faults_;
  std::size_t faults_not_told_ = 0;
  std::vector<std::pair<const Option*, ParsedValue>> values_;
};

}  // namespace

std::string value_text(const Option& option) {
  switch (option.value.index()) {
    case 0:
      return format_quantity(*std::get<double*>(option.value), option.unit);
    case 1:
      return format_quantity(static_cast<double>(*std::get<std::int32_t*>(option.value)), option.unit);
    case 2:
      return *std::get<bool*>(option.value) ? "true" : "false";
    default:
      return std::string(std::get<Choice>(option.value).get());
  }
}

std::vector<std::string> read_config_text(std::string_view text, const std::string& name,
                                          std::span<const Option> options) {
  if (text.size() > kMaxYamlBytes) {
    throw ConfigError({name, 0}, fmt::format("is longer than the {} bytes that are read", kMaxYamlBytes));
  }
  const YAML::Node root = parse_yaml<ConfigError>(std::string(text), name);
  ConfigDocument document(name, options);
  if (root.IsMap()) {
    document.visit(root, "");
  } else if (root.IsDefined() && !root.IsNull()) {
    throw ConfigError({name, find_line(root)}, "a configuration is a map of sections, options and values");
  }
  return document.apply();
}

std::vector<std::string> read_config(const std::string& path, std::span<const Option> options) {
  return read_config_text(read_text<ConfigError>(path, kMaxYamlBytes), path == "-" ? "standard input" : path, options);
}

std::string set_option(std::span<const Option> options, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw ConfigError(
        fmt::format("{} is no assignment; write path=value, such as map.resolution=5cm", in_quotes(assignment)));
  }
  std::string path(assignment.substr(0, equals));
  for (const Option& option : options) {
    if (option.path == path) {
      try {
        store(option, parse_option_value(option, assignment.substr(equals + 1), BareNumber::kRefused));
      } catch (const std::invalid_argument& error) {
        throw ConfigError(error.what());
      }
      return path;
    }
  }
  throw ConfigError(unknown_name(path, options));
}

}  // namespace gdtslam
