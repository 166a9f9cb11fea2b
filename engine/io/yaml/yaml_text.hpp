// The only reader of YAML texts. It bounds the text for yaml-cpp, which recurses for each nested bracket or indent,
// takes some hundred bytes for a value and never returns from some faulty texts of several documents. Thread-safe;
// linear in the text.
#pragma once

#include <cstddef>
#include <limits>
#include <string>

namespace YAML {  // NOLINT(readability-identifier-naming): yaml-cpp's name
class Node;
}

namespace gdtslam {

/// The file's text, "-" being standard input. Throws FileError, or `Failure` (InputError or ConfigError) for a file of
/// more than `most_bytes`.
template <class Failure>
std::string read_text(const std::string& path, std::size_t most_bytes = std::numeric_limits<std::size_t>::max());

/// The only document of a text; `name` is for messages. Throws `Failure` with the line for invalid YAML, a second
/// document, nesting deeper than 32 brackets or 256 blanks, or more than kMaxYamlNodes values (io/file_limits.hpp).
template <class Failure>
YAML::Node parse_yaml(const std::string& text, const std::string& name);

}  // namespace gdtslam
