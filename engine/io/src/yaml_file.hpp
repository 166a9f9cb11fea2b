// YAML documents by yaml-cpp, with our errors: what is wrong, file and line. Only io's own sources include this.
#pragma once

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>

#include "gdtslam/core/error.hpp"
#include "gdtslam/io/message_text.hpp"
#include "gdtslam/io/yaml_text.hpp"

namespace gdtslam {

/// The largest YAML file that is read.
inline constexpr std::size_t kMaxYamlBytes = std::size_t{1} << 20;

/// The file's text. Throws FileError or InputError.
std::string read_yaml_text(const std::string& path);

inline std::uint64_t line_of(const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.line < 0 ? 0 : static_cast<std::uint64_t>(mark.line) + 1;
}

/// Parses a document; `Failure` is the error type to throw (InputError or ConfigError).
template <class Failure>
YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  if (is_nested_too_deep(text)) {
    throw Failure({name, 0}, "is nested too deeply for a file of this kind");
  }
  try {
    if (goes_on_after_its_document(text)) {
      throw Failure({name, 0}, "holds more than one YAML document");
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Failure({name, static_cast<std::uint64_t>(error.mark.line + 1)},
                  fmt::format("is no YAML: {}", one_line(error.msg)));
  }
}

/// A flat description file (map.yaml, gdt.yaml): a map of known keys to scalars or sequences of numbers.
class DescriptionFile {
 public:
  explicit DescriptionFile(const std::string& path);
  [[nodiscard]] bool has(const char* key) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number_or(const char* key, double value) const { return has(key) ? number(key) : value; }
  /// x, y and yaw; the yaw must be 0.
  struct Origin {
    double x_m = 0.0;
    double y_m = 0.0;
  };
  [[nodiscard]] Origin origin() const;
  /// Resolution in metres, checked.
  [[nodiscard]] double resolution_m() const;
  /// The file that the key `image` names, in or below this file's folder; anything else is refused.
  [[nodiscard]] std::string image_path() const;
  [[noreturn]] void fail(const char* key, const std::string& message) const;

 private:
  [[nodiscard]] YAML::Node node(const char* key) const;
  [[nodiscard]] double number_of(const YAML::Node& node, const char* key) const;

  std::string path_;
  YAML::Node root_;
};

/// The shortest text that reads back as the same double, in a form that YAML 1.1 and 1.2 readers take for a number.
std::string yaml_number(double value);

}  // namespace gdtslam
