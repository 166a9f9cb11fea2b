#include <fmt/format.h>

#include <utility>

#include "cloud_file_layout.hpp"
#include "cloud_words.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostProperties = 1000;
constexpr std::size_t kMostElements = 100;
constexpr std::uint64_t kMostHeaderLines = 100'000;

using LineWords = std::vector<std::string_view>;

Scalar find_scalar(std::string_view word, const FilePosition& at) {
  const bool is_of_pcd = !word.empty() && word[0] <= 'Z';
  const std::optional<Scalar> type = is_of_pcd ? std::nullopt : scalar_named(word);
  if (!type) throw InputError(at, fmt::format("{} is no type of PLY", in_quotes(word)));
  return *type;
}

void set_format(const LineWords& words, PlyHeader& header, const FilePosition& at) {
  if (words.size() < 2) throw InputError(at, "the format is missing: ascii, binary_little_endian, binary_big_endian");
  header.is_ascii = words[1] == "ascii";
  header.is_big_endian = words[1] == "binary_big_endian";
  if (!header.is_ascii && words[1] != "binary_little_endian" && !header.is_big_endian) {
    throw InputError(
        at, fmt::format("{} is no format of PLY: ascii, binary_little_endian, binary_big_endian", in_quotes(words[1])));
  }
}

CloudElement read_element(const LineWords& words, const FilePosition& at) {
  const std::optional<std::uint64_t> count = words.size() == 3 ? parse_count(words[2]) : std::nullopt;
  if (!count) throw InputError(at, "expected 'element NAME COUNT'");
  return {.count = *count, .is_vertex = words[1] == "vertex", .is_face = words[1] == "face", .columns = {}};
}

CloudColumn read_column(const LineWords& words, const FilePosition& at) {
  if (words.size() == 3) return {.type = find_scalar(words[1], at), .role = column_role(words[2])};
  if (words.size() == 5 && words[1] == "list") {
    const Scalar count = find_scalar(words[2], at);
    if (count == Scalar::kFloat || count == Scalar::kDouble)
      throw InputError(at, "the length of a list is a whole number");
    const bool is_corner_list = words[4] == "vertex_indices" || words[4] == "vertex_index";
    return {.type = find_scalar(words[3], at), .list_count = count, .is_corner_list = is_corner_list};
  }
  throw InputError(at, "expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
}

// Elements before the vertices are skipped; later ones do not matter.
void sort_elements(std::vector<CloudElement> elements, CloudFileLayout& layout, const std::string& name) {
  for (CloudElement& element : elements) {
    if (element.is_vertex) {
      layout.has_more = &element != &elements.back();
      layout.vertex = std::move(element);
      return;
    }
    layout.before.push_back(std::move(element));
  }
  throw InputError({name, 0}, "has no element 'vertex', so it holds no points");
}

// Reads one line between "ply" and "end_header".
void take(const LineWords& words, PlyHeader& header, const FilePosition& at) {
  std::vector<CloudElement>& elements = header.elements;
  if (words[0] == "format") {
    set_format(words, header, at);
  } else if (words[0] == "element") {
    if (elements.size() == kMostElements) throw InputError(at, "more than 100 elements");
    elements.push_back(read_element(words, at));
  } else if (words[0] == "property") {
    if (elements.empty()) throw InputError(at, "a property before the first element");
    if (elements.back().columns.size() == kMostProperties) throw InputError(at, "more than 1000 properties");
    elements.back().columns.push_back(read_column(words, at));
  } else {
    throw InputError(at, fmt::format("{} is no keyword of a PLY header", in_quotes(words[0])));
  }
}

}  // namespace

PlyHeader read_ply_elements(CloudInput& input) {
  PlyHeader header;
  bool has_format = false;
  while (const std::optional<std::string_view> line = input.line()) {
    const FilePosition at{input.name(), input.line_number()};
    if (at.line > kMostHeaderLines) throw InputError(at, "the PLY header has more than 100000 lines");
    const LineWords words = split_words(*line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] != "end_header") {
      take(words, header, at);
      has_format = has_format || words[0] == "format";
      continue;
    }
    if (!has_format) throw InputError(at, "the header has no 'format' line");
    return header;
  }
  throw InputError({input.name(), 0}, "the PLY header has no 'end_header'; is the file whole?");
}

CloudFileLayout read_ply_header(CloudInput& input) {
  PlyHeader header = read_ply_elements(input);
  CloudFileLayout layout;
  layout.is_ascii = header.is_ascii;
  layout.is_big_endian = header.is_big_endian;
  sort_elements(std::move(header.elements), layout, input.name());
  return layout;
}

}  // namespace gdtslam
