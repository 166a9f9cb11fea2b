#include "yaml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/io/decimal.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/referenced_file.hpp"
#include "yaml_text.hpp"

namespace gdtslam {

DescriptionFile::DescriptionFile(const std::string& path) : path_(path) {
  root_ = parse_yaml<InputError>(read_text<InputError>(path, kMaxYamlBytes), path);
  if (!root_.IsMap()) {
    throw InputError({path, 0}, "is no YAML map of keys and values");
  }
}

bool DescriptionFile::has(const char* key) const { return node(key).IsDefined(); }

YAML::Node DescriptionFile::node(const char* key) const {
  const YAML::Node& root = root_;  // the const operator adds no key
  return root[key];
}

void DescriptionFile::fail(const char* key, const std::string& message) const {
  const std::uint64_t line = has(key) ? find_line(node(key)) : 0;
  throw InputError({path_, line}, fmt::format("{}: {}", key, message));
}

std::string DescriptionFile::text(const char* key) const {
  if (!has(key)) {
    throw InputError({path_, 0}, fmt::format("the key {} is missing", key));
  }
  if (!node(key).IsScalar()) {
    fail(key, "must be a single value");
  }
  return node(key).Scalar();
}

double DescriptionFile::parse_number(const YAML::Node& node, const char* key) const {
  double value = 0.0;
  const std::string text = node.IsScalar() ? node.Scalar() : std::string();
  const char* const end = text.data() + text.size();
  if (text.empty() || parse_double(text.data(), end, value) != end || !std::isfinite(value)) {
    fail(key, fmt::format("{} is no finite number", in_quotes(text)));
  }
  return value;
}

double DescriptionFile::number(const char* key) const {
  static_cast<void>(text(key));
  return parse_number(node(key), key);
}

GridGeometry DescriptionFile::geometry() const {
  const double resolution_m = number("resolution");
  if (resolution_m <= 0.0) {
    fail("resolution", fmt::format("{} m is not above 0", resolution_m));
  }
  if (!has("origin")) {
    throw InputError({path_, 0}, "the key origin is missing");
  }
  const YAML::Node list = node("origin");
  if (!list.IsSequence() || list.size() != 3) {
    fail("origin", "must be [x, y, yaw]");
  }
  if (parse_number(list[2], "origin") != 0.0) {
    fail("origin", "a map that is turned (yaw other than 0) cannot be read; turn its picture and state a yaw of 0");
  }
  return {resolution_m, parse_number(list[0], "origin"), parse_number(list[1], "origin"), 0, 0};
}

std::string DescriptionFile::image_path() const {
  const std::string image = text("image");
  if (const std::string fault = fault_of_reference(path_, image); !fault.empty()) {
    fail("image", fault);
  }
  return referenced_path(path_, image);
}

std::string yaml_number(double value) {
  std::string text = fmt::format("{}", value);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) {
    text.insert(std::min(exponent, text.size()), ".0");  // YAML 1.1 reads 1e-07 as a text
  }
  return text;
}

}  // namespace gdtslam
