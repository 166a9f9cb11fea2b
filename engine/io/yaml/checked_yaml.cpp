#include "checked_yaml.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/yaml/yaml_file.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostTextBytes = std::size_t{1} << 16;  // an alias may repeat a text a hundred thousand times
constexpr std::size_t kMostNumberBytes = 200;

// What a message quotes from a file may hold anything; the message stays one line of readable text.
constexpr std::size_t kMostShown = 400;

std::string_view without_suffix(std::string_view text, std::string_view suffix) {
  if (!suffix.empty() && text.ends_with(suffix)) {
    text.remove_suffix(suffix.size());
  }
  return text;
}

bool is_bare_number(std::string_view text) {
  return text.find_first_not_of("+-.0123456789eE \t") == std::string_view::npos;
}

}  // namespace

YamlValue::YamlValue(const YAML::Node& node, std::string file, std::string name)
    : node_(node), file_(std::move(file)), name_(std::move(name)) {}

void YamlValue::refuse(const std::string& fault) const {
  throw ConfigError({file_, line_of(node_)}, one_line(name_.empty() ? fault : name_ + ": " + fault, kMostShown));
}

void YamlValue::require_none(const std::vector<std::string>& faults) const {
  if (!faults.empty()) {
    refuse(faults.front());
  }
}

std::string YamlValue::scalar() const {
  if (!node_.IsScalar()) {
    refuse("a single value is expected here");
  }
  if (node_.Scalar().size() > kMostTextBytes) {
    refuse("a text of more than " + std::to_string(kMostTextBytes) + " bytes is not accepted");
  }
  return node_.Scalar();
}

double YamlValue::number(const Quantity& quantity) const {
  const std::string text = scalar();
  if (text.size() > kMostNumberBytes) {
    refuse("a number of more than " + std::to_string(kMostNumberBytes) + " characters is not accepted");
  }
  std::string why;
  const std::optional<double> value = parse_quantity(without_suffix(text, quantity.suffix), quantity.unit, &why);
  if (!value) {
    refuse("'" + text + "' is no value for this: " + why);
  }
  if (quantity.unit == Unit::kRadian && *value != 0.0 && is_bare_number(without_suffix(text, quantity.suffix))) {
    refuse("an angle needs its unit: write '" + text + " deg' or '" + text + " rad'");
  }
  return *value;
}

std::size_t YamlValue::count() const {
  constexpr double kMost = 1e9;
  const double value = number({});
  if (!(value >= 0.0 && value <= kMost) || value != static_cast<double>(static_cast<std::size_t>(value))) {
    refuse("'" + scalar() + "' is not a whole number from 0 to 1000000000");
  }
  return static_cast<std::size_t>(value);
}

bool YamlValue::flag() const {
  const std::string text = scalar();
  if (text != "true" && text != "false") {
    refuse("'" + text + "' is neither true nor false");
  }
  return text == "true";
}

std::string YamlValue::text() const { return scalar(); }

Point2 YamlValue::point() const {
  if (!node_.IsSequence() || node_.size() != 2) {
    refuse("a point [x, y] is expected here");
  }
  const Quantity length{Unit::kMetre};
  return {YamlValue(node_[0], file_, name_).number(length), YamlValue(node_[1], file_, name_).number(length)};
}

std::vector<YamlValue> YamlValue::entries() const {
  if (!node_.IsSequence()) {
    refuse("a list is expected here");
  }
  if (node_.size() > kMaxYamlEntries) {
    refuse("a list of more than " + std::to_string(kMaxYamlEntries) + " entries is not accepted");
  }
  std::vector<YamlValue> values;
  for (const YAML::Node& entry : node_) {
    values.emplace_back(entry, file_, name_ + "[" + std::to_string(values.size()) + "]");
  }
  return values;
}

YamlMapping::YamlMapping(const YamlValue& value) : value_(value) {
  if (!value.is_mapping()) {
    value.refuse("keys with values are expected here");
  }
  std::set<std::string> seen;
  for (const auto& entry : value.node()) {
    const YamlValue key(entry.first, value.file(), value.name());
    if (!seen.insert(key.text()).second) {
      key.refuse("the key '" + key.text() + "' stands twice");
    }
  }
}

std::optional<YamlValue> YamlMapping::find(const std::string& key) {
  asked_.push_back(key);
  for (const auto& entry : value_.node()) {
    if (entry.first.Scalar() != key) {
      continue;
    }
    if (entry.second.IsNull()) {
      // An empty value has no place of its own in the file.
      YamlValue(entry.first, value_.file(), value_.name()).refuse("the key '" + key + "' has no value");
    }
    return YamlValue(entry.second, value_.file(), value_.name().empty() ? key : value_.name() + "." + key);
  }
  return std::nullopt;
}

YamlValue YamlMapping::require(const std::string& key) {
  const std::optional<YamlValue> value = find(key);
  if (!value) {
    value_.refuse("the key '" + key + "' is missing");
  }
  return *value;
}

void YamlMapping::read(const std::string& key, const Quantity& quantity, double& value) {
  if (const std::optional<YamlValue> given = find(key)) {
    value = given->number(quantity);
  }
}

void YamlMapping::read(const std::string& key, bool& value) {
  if (const std::optional<YamlValue> given = find(key)) {
    value = given->flag();
  }
}

void YamlMapping::read(const std::string& key, std::string& value) {
  if (const std::optional<YamlValue> given = find(key)) {
    value = given->text();
  }
}

std::vector<YamlValue> YamlMapping::list(const std::string& key) {
  const std::optional<YamlValue> given = find(key);
  return given ? given->entries() : std::vector<YamlValue>();
}

void YamlMapping::finish() const {
  for (const auto& entry : value_.node()) {
    const YamlValue key(entry.first, value_.file(), value_.name());
    if (std::find(asked_.begin(), asked_.end(), key.text()) == asked_.end()) {
      key.refuse("unknown key '" + key.text() + "'" + did_you_mean(key.text(), asked_));
    }
  }
}

}  // namespace gdtslam
