// Descriptions of maps in YAML. Only io's own sources include this.
#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <string>

#include "gdtslam/core/error.hpp"
#include "gdtslam/core/grid_geometry.hpp"

namespace gdtslam {

/// The line from 1; 0 if unknown.
inline std::uint64_t find_line(const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.line < 0 ? 0 : static_cast<std::uint64_t>(mark.line) + 1;
}

/// A flat description file (map.yaml, gdt.yaml): a map of known keys to scalars or sequences of numbers.
class DescriptionFile {
 public:
  explicit DescriptionFile(const std::string& path);
  [[nodiscard]] bool has(const char* key) const;
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number_or(const char* key, double value) const { return has(key) ? number(key) : value; }
  /// Geometry from the keys resolution, above 0, and origin, whose yaw must be 0; the size is the image's.
  [[nodiscard]] GridGeometry geometry() const;
  /// The file of the key `image`, in or below this file's folder; anything else is refused.
  [[nodiscard]] std::string image_path() const;
  [[noreturn]] void fail(const char* key, const std::string& message) const;

 private:
  [[nodiscard]] YAML::Node node(const char* key) const;
  [[nodiscard]] double parse_number(const YAML::Node& node, const char* key) const;

  std::string path_;
  YAML::Node root_;
};

/// The shortest text that reads back as the same double, in a form that YAML 1.1 and 1.2 readers accept as a number.
std::string yaml_number(double value);

}  // namespace gdtslam
