// Reading YAML so that nothing in it is ignored: a mapping hands out its keys one by one and, when it is finished with,
// refuses those that nobody asked for, naming the nearest one that somebody did. Every message has file and line.
// Quantities carry their unit ("5 cm", "2 deg/s"); a bare number is in metres, seconds or hertz, but an angle needs its
// unit, because 90 is rather meant in degrees. Not thread-safe.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// What a number measures: a unit and what it is counted per, for example {Unit::kRadian, "/s"} or {Unit::kNone, "Hz"}.
struct Quantity {
  Unit unit = Unit::kNone;
  std::string_view suffix = "";  ///< may be left out of a bare number
};

/// Lists of more entries than this are refused.
inline constexpr std::size_t kMaxYamlEntries = 100'000;

/// A node with its file and its name in it ("walls[2].doors[0]"), for messages.
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
  /// Throws ConfigError at this value when there is a fault.
  void require_none(const std::vector<std::string>& faults) const;

 private:
  [[nodiscard]] std::string scalar() const;

  YAML::Node node_;
  std::string file_;
  std::string name_;
};

/// A mapping whose keys are all accounted for. Call finish() after the last key was asked for.
class YamlMapping {
 public:
  explicit YamlMapping(const YamlValue& value);

  [[nodiscard]] std::optional<YamlValue> find(const std::string& key);
  [[nodiscard]] YamlValue require(const std::string& key);
  /// The value of the key where it is given, else what `value` holds stays.
  void read(const std::string& key, const Quantity& quantity, double& value);
  void read(const std::string& key, bool& value);
  void read(const std::string& key, std::string& value);
  /// The entries of the list of that name; none when it is absent.
  [[nodiscard]] std::vector<YamlValue> list(const std::string& key);
  void finish() const;
  [[nodiscard]] const YamlValue& value() const { return value_; }

 private:
  YamlValue value_;
  std::vector<std::string> asked_;
};

}  // namespace gdtslam
