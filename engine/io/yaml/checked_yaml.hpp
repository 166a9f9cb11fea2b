// Reads YAML without ignoring anything: a mapping is read by a table of its fields, and an unknown key is refused with
// the nearest known one. Every message has file and line. Quantities have units ("5 cm", "2 deg/s"); a bare number is
// in metres, seconds or hertz, but an angle needs its unit, because 90 probably means degrees. Not thread-safe.
#pragma once

#include <concepts>
#include <cstddef>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// The kind of a number: a unit and a suffix, for example {Unit::kRadian, "/s"} or {Unit::kNone, "Hz"}.
struct Quantity {
  Unit unit = Unit::kNone;
  std::string_view suffix = "";  ///< may be omitted from a bare number
};

/// Lists of more entries than this are refused.
inline constexpr std::size_t kMaxYamlEntries = 100'000;

/// A node with its file and its path in the file ("walls[2].doors[0]"), for messages.
class YamlValue {
 public:
  YamlValue(const YAML::Node& node, std::string file, std::string name);

  [[nodiscard]] double number(const Quantity& quantity) const;
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] bool flag() const;
  [[nodiscard]] std::string text() const;
  /// Two lengths: [x, y].
  [[nodiscard]] Point2 point() const;
  /// The entries of a list.
  [[nodiscard]] std::vector<YamlValue> entries() const;
  [[nodiscard]] bool is_mapping() const { return node_.IsMap(); }
  [[nodiscard]] bool is_list() const { return node_.IsSequence(); }
  [[nodiscard]] const YAML::Node& node() const { return node_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Throws ConfigError at this value.
  [[noreturn]] void refuse(const std::string& fault) const;
  /// The same at the key that the fault begins with, "bars.crank = ..." or "recording: scan_rate ...", if the file has
  /// it.
  [[noreturn]] void refuse_below(const std::string& fault) const;
  /// Throws ConfigError at this value if there is a fault.
  void require_none(const std::vector<std::string>& faults) const;

 private:
  [[nodiscard]] std::string scalar() const;

  YAML::Node node_;
  std::string file_;
  std::string name_;
};

/// A key of a mapping, and the target of its value. Missing keys leave their targets unchanged.
struct YamlField {
  using Read = std::function<void(const YamlValue&)>;

  YamlField(const char* name, const Quantity& quantity, double& target)
      : YamlField(name, [quantity, &target](const YamlValue& value) { target = value.number(quantity); }) {}
  YamlField(const char* name, bool& target)
      : YamlField(name, [&target](const YamlValue& value) { target = value.flag(); }) {}
  YamlField(const char* name, std::string& target)
      : YamlField(name, [&target](const YamlValue& value) { target = value.text(); }) {}
  YamlField(const char* name, Point2& target)
      : YamlField(name, [&target](const YamlValue& value) { target = value.point(); }) {}
  template <std::invocable<const YamlValue&> Reader>
  YamlField(const char* name, Reader reader) : key(name), read(std::move(reader)) {}

  const char* key;
  Read read;
  bool is_required = false;
};
inline YamlField required(YamlField field) {
  field.is_required = true;
  return field;
}

/// Reads a mapping by its fields, in their order; returns the given keys. Throws ConfigError for an unknown key, a key
/// given twice or without a value, and for a missing required one.
std::set<std::string> read_fields(const YamlValue& value, const std::vector<YamlField>& fields);

/// The value of the key that names a format. Throws ConfigError for a version other than 1.
void require_version_1(const YamlValue& version);

}  // namespace gdtslam
