#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/units.hpp"
#include "gdtslam/io/config_yaml.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

struct SplitPath {
  std::string_view section;  ///< everything before the last dot, empty at the top
  std::string_view name;
};
SplitPath split(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? SplitPath{{}, path} : SplitPath{path.substr(0, dot), path.substr(dot + 1)};
}

/// The allowed values of an option, for people: bounds or names; empty for a switch.
std::string bounds_text(const Option& option) {
  if (const auto* choice = std::get_if<Choice>(&option.value)) {
    return fmt::format(" ({})", fmt::join(choice->names(), ", "));
  }
  if (std::holds_alternative<bool*>(option.value)) {
    return {};
  }
  return fmt::format(" ({} to {})", show_quantity(option.min, option.unit), show_quantity(option.max, option.unit));
}

/// An angle in degrees beside its exact value in radians, for people.
std::string degrees_text(const Option& option) {
  const bool is_angle = option.unit == Unit::kRadian && std::holds_alternative<double*>(option.value);
  return is_angle ? fmt::format("  # {:.6g} deg", deg_from_rad(*std::get<double*>(option.value))) : std::string();
}

/// Sections in the order in which they first occur; the options at the top first.
std::vector<std::string_view> list_sections(std::span<const Option> options) {
  std::vector<std::string_view> sections = {std::string_view()};
  for (const Option& option : options) {
    const std::string_view section = split(option.path).section;
    if (std::find(sections.begin(), sections.end(), section) == sections.end()) {
      sections.push_back(section);
    }
  }
  return sections;
}

/// Writes a section of several parts with dots ("a.b:"), which reads back as the same path.
void append_section(std::string& text, std::string_view section, std::span<const Option> options) {
  const std::string_view indent = section.empty() ? "" : "  ";
  if (!section.empty()) {
    fmt::format_to(std::back_inserter(text), "\n{}:\n", section);
  }
  for (const Option& option : options) {
    if (split(option.path).section == section) {
      fmt::format_to(std::back_inserter(text), "{}# {}{}\n{}{}: {}{}\n", indent, option.doc, bounds_text(option),
                     indent, split(option.path).name, value_text(option), degrees_text(option));
    }
  }
}

Json make_schema(const Option& option) {
  Json schema = {{"description", option.doc}, {"default", value_text(option)}};
  if (const auto* choice = std::get_if<Choice>(&option.value)) {
    for (const std::string_view name : choice->names()) {
      schema["enum"].push_back(name);
    }
  } else if (std::holds_alternative<bool*>(option.value)) {
    schema["type"] = "boolean";
    schema["default"] = *std::get<bool*>(option.value);
  } else {
    const bool is_whole = std::holds_alternative<std::int32_t*>(option.value);
    const Json number = {{"type", is_whole ? "integer" : "number"}, {"minimum", option.min}, {"maximum", option.max}};
    const Json quantity = {{"type", "string"}, {"pattern", "^ *[-+]?[0-9.]+([eE][-+]?[0-9]+)? *[A-Za-z%]* *$"}};
    schema["anyOf"] = {number, quantity};
    if (!unit_symbol(option.unit).empty()) {
      schema["x-unit"] = unit_symbol(option.unit);
    }
  }
  return schema;
}

/// The object of the section's options, made if missing.
Json& object_at(Json& root, std::string_view section) {
  Json* object = &root;
  while (!section.empty()) {
    const std::size_t dot = std::min(section.find('.'), section.size());
    Json& child = (*object)["properties"][std::string(section.substr(0, dot))];
    if (child.is_null()) child = Json::object();
    child["type"] = "object";
    child["additionalProperties"] = false;
    object = &child;
    section.remove_prefix(std::min(dot + 1, section.size()));
  }
  return *object;
}

}  // namespace

std::string config_text(std::span<const Option> options) {
  std::string text = "# Configuration of gdtslam. Values carry their units: 5 cm, 2 deg, 250 ms.\nversion: 1\n";
  for (const std::string_view section : list_sections(options)) {
    append_section(text, section, options);
  }
  return text;
}

std::string config_schema(std::span<const Option> options) {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "Configuration of gdtslam"},
                 {"type", "object"},
                 {"additionalProperties", false}};
  schema["properties"]["version"] = {{"description", "Version of the format of configuration files"}, {"const", 1}};
  for (const Option& option : options) {
    const SplitPath path = split(option.path);
    object_at(schema, path.section)["properties"][std::string(path.name)] = make_schema(option);
  }
  return schema.dump(2) + "\n";
}

}  // namespace gdtslam
