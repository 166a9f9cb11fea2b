// Options are declared once: a table of rows feeds the reader of configuration files, the defaults, `gdtslam config
// show`, the reference page and the hints for misspelt names. Rows point into the struct that holds the values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// An enumeration seen as names: the index of the value and the names in the order of the values.
class Choice {
 public:
  template <class E>
  Choice(E& value, std::span<const std::string_view> names)
      : value_(&value),
        names_(names),
        get_([](const void* p) { return static_cast<std::size_t>(*static_cast<const E*>(p)); }),
        set_([](void* p, std::size_t i) { *static_cast<E*>(p) = static_cast<E>(i); }) {}

  [[nodiscard]] std::span<const std::string_view> names() const { return names_; }
  [[nodiscard]] std::string_view get() const { return names_[get_(value_)]; }
  /// False if there is no such name.
  bool set(std::string_view name) const;

 private:
  void* value_;
  std::span<const std::string_view> names_;
  std::size_t (*get_)(const void*);
  void (*set_)(void*, std::size_t);
};

/// Whether an option is shown to everyone, or by `config show --all` and on a page of its own.
enum class Audience : std::uint8_t { kEveryone, kAdvanced };
inline constexpr Audience kAdvanced = Audience::kAdvanced;

/// One option: its path, meaning, unit and bounds (both bounds are allowed values).
struct Option {
  std::string_view path;  ///< "merge.threshold"
  std::string_view doc;
  Unit unit = Unit::kNone;
  double min = 0.0;
  double max = 0.0;
  std::variant<double*, std::int32_t*, bool*, Choice> value;
  Audience audience = Audience::kEveryone;
};

/// Violations in the values of a table: a text for each, with path, value and bound. Empty if all values are allowed.
std::vector<std::string> violations(std::span<const Option> options);

}  // namespace gdtslam
