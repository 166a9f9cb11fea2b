#include "checked_yaml.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/io/did_you_mean.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/yaml/yaml_file.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostTextBytes = std::size_t{1} << 16;  // an alias may repeat a text a hundred thousand times
constexpr std::size_t kMostNumberBytes = 200;

// A quote from a file in a message is one line of readable text of at most this length.
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
  throw ConfigError({file_, find_line(node_)}, one_line(name_.empty() ? fault : name_ + ": " + fault, kMostShown));
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

void YamlValue::refuse_below(const std::string& fault) const {
  constexpr std::string_view kKeyCharacters = "abcdefghijklmnopqrstuvwxyz_";
  YAML::Node place = node_;
  std::string_view rest = fault;
  while (place.IsMap()) {
    const std::size_t end = std::min(rest.find_first_not_of(kKeyCharacters), rest.size());
    const YAML::Node& mapping = place;  // the const operator adds no key
    const YAML::Node below = mapping[std::string(rest.substr(0, end))];
    if (!below.IsDefined()) break;
    place.reset(below);
    rest.remove_prefix(std::min(rest.find_first_of(kKeyCharacters, end), rest.size()));
  }
  YamlValue(place, file_, "").refuse(fault);
}

std::set<std::string> read_fields(const YamlValue& value, const std::vector<YamlField>& fields) {
  if (!value.is_mapping()) value.refuse("keys with values are expected here");
  std::map<std::string, YamlValue> given;
  for (const auto& entry : value.node()) {
    const YamlValue at_key(entry.first, value.file(), value.name());
    const std::string key = at_key.text();
    if (given.contains(key)) at_key.refuse("the key '" + key + "' stands twice");
    const auto is_key = [&key](const YamlField& field) { return key == field.key; };
    if (std::none_of(fields.begin(), fields.end(), is_key)) {
      std::vector<std::string> known;
      known.reserve(fields.size());
      for (const YamlField& field : fields) known.emplace_back(field.key);
      at_key.refuse("unknown key '" + key + "'" + did_you_mean(key, known));
    }
    if (entry.second.IsNull()) at_key.refuse("the key '" + key + "' has no value");  // a null has no place of its own
    given.emplace(key, YamlValue(entry.second, value.file(), value.name().empty() ? key : value.name() + "." + key));
  }
  std::set<std::string> keys;
  for (const YamlField& field : fields) {
    const auto found = given.find(field.key);
    if (found != given.end()) {
      field.read(found->second);
      keys.insert(field.key);
    } else if (field.is_required) {
      value.refuse("the key '" + std::string(field.key) + "' is missing");
    }
  }
  return keys;
}

void require_version_1(const YamlValue& version) {
  if (version.text() != "1") {
    version.refuse("version '" + version.text() + "' is not known; this program reads version 1");
  }
}

}  // namespace gdtslam
