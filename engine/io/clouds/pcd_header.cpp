#include <fmt/format.h>

#include <utility>

#include "cloud_file_layout.hpp"
#include "cloud_words.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostColumns = 1000;
constexpr std::uint64_t kMostLines = 10'000;
constexpr std::uint64_t kMostColumnValues = 8000;  // limit for one column of a point

using Words = std::vector<std::string>;

struct PcdHeader {
  Words fields;
  Words sizes;
  Words types;
  Words counts;
  std::optional<std::uint64_t> width;
  std::optional<std::uint64_t> height;
  std::optional<std::uint64_t> points;
  std::string data;
};

Scalar find_scalar(std::string_view type, std::string_view size, const FilePosition& at) {
  const std::optional<Scalar> found =
      type == "I" || type == "U" || type == "F" ? scalar_named(std::string(type) + std::string(size)) : std::nullopt;
  if (!found)
    throw InputError(at, fmt::format("TYPE {} with SIZE {} is none of PCD's", in_quotes(type), in_quotes(size)));
  return *found;
}

std::uint64_t read_number(const Words& words, const FilePosition& at) {
  const std::optional<std::uint64_t> value = words.size() == 2 ? parse_count(words[1]) : std::nullopt;
  if (!value) throw InputError(at, fmt::format("{} needs one whole number", words[0]));
  return *value;
}

// False for an ignored keyword.
bool take(const Words& words, PcdHeader& header, const FilePosition& at) {
  const Words values(words.begin() + 1, words.end());
  if (words[0] == "FIELDS" || words[0] == "COLUMNS") return header.fields = values, true;
  if (words[0] == "SIZE") return header.sizes = values, true;
  if (words[0] == "TYPE") return header.types = values, true;
  if (words[0] == "COUNT") return header.counts = values, true;
  if (words[0] == "WIDTH") return header.width = read_number(words, at), true;
  if (words[0] == "HEIGHT") return header.height = read_number(words, at), true;
  if (words[0] == "POINTS") return header.points = read_number(words, at), true;
  if (words[0] == "DATA") return header.data = values.empty() ? "" : values[0], true;
  return words[0] == "VERSION" || words[0] == "VIEWPOINT";
}

std::uint64_t read_point_count(const PcdHeader& header, const FilePosition& at) {
  if (!header.width && !header.points) throw InputError(at, "the header has neither POINTS nor WIDTH");
  const std::uint64_t height = header.height.value_or(1);
  const std::uint64_t width = header.width.value_or(header.points.value_or(0));
  if (height != 0 && width > UINT64_MAX / height) throw InputError(at, "WIDTH times HEIGHT is beyond all bounds");
  const std::uint64_t points = header.width ? width * height : *header.points;
  if (header.points && *header.points != points) {
    throw InputError(at, fmt::format("POINTS is {}, WIDTH times HEIGHT {}", *header.points, points));
  }
  return points;
}

// One column; before version 0.6 files have no SIZE and TYPE, and all columns are floats.
CloudColumn read_column(const PcdHeader& header, std::size_t k, const FilePosition& at) {
  const std::string_view type = header.types.empty() ? std::string_view("F") : header.types[k];
  const std::string_view size = header.sizes.empty() ? std::string_view("4") : header.sizes[k];
  const std::optional<std::uint64_t> repeat = header.counts.empty() ? 1 : parse_count(header.counts[k]);
  if (!repeat || *repeat > kMostColumnValues) throw InputError(at, "COUNT has a value that is not a number up to 8000");
  return {.type = find_scalar(type, size, at), .role = column_role(header.fields[k]), .repeat = *repeat};
}

CloudFileLayout make_layout(const PcdHeader& header, const FilePosition& at) {
  const std::size_t fields = header.fields.size();
  if (fields == 0 || fields > kMostColumns) throw InputError(at, "FIELDS names no column, or more than 1000");
  for (const Words* words : {&header.sizes, &header.types, &header.counts}) {
    if (!words->empty() && words->size() != fields) {
      throw InputError(at, "FIELDS, SIZE, TYPE and COUNT have different lengths");
    }
  }
  CloudFileLayout layout;
  layout.vertex.is_vertex = true;
  layout.vertex.count = read_point_count(header, at);
  for (std::size_t k = 0; k < fields; ++k) layout.vertex.columns.push_back(read_column(header, k, at));
  layout.is_ascii = header.data == "ascii";
  layout.is_compressed = header.data == "binary_compressed";
  if (!layout.is_ascii && header.data != "binary" && !layout.is_compressed) {
    throw InputError(at,
                     fmt::format("DATA is {}, expected ascii, binary or binary_compressed", in_quotes(header.data)));
  }
  return layout;
}

}  // namespace

CloudFileLayout read_pcd_header(CloudInput& input, const std::string& first_line) {
  PcdHeader header;
  std::optional<std::string> line = first_line;
  while (line && input.line_number() <= kMostLines) {
    const FilePosition at{input.name(), input.line_number()};
    Words words;
    for (const std::string_view word : split_words(*line)) words.emplace_back(word);
    if (!words.empty() && !words[0].starts_with('#') && !take(words, header, at)) {
      throw InputError(at, fmt::format("{} is no keyword of a PCD header", in_quotes(words[0])));
    }
    if (!words.empty() && words[0] == "DATA") return make_layout(header, at);
    const std::optional<std::string_view> next = input.line();
    line = next ? std::optional<std::string>(*next) : std::nullopt;
  }
  throw InputError({input.name(), 0}, "the PCD header has no DATA line; is the file whole?");
}

// A control byte below 32: that many literals plus one. Else three bits of length (7: one more byte follows) and a
// distance of 13 bits back, length plus two bytes to repeat.
std::optional<std::string> unpack_lzf(std::string_view packed, std::size_t size) {
  constexpr std::size_t kLiterals = 32;
  std::string data;
  data.reserve(size);
  std::size_t at = 0;
  const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(packed[at++])); };
  while (at < packed.size()) {
    const std::size_t control = byte();
    if (control < kLiterals) {
      const std::size_t count = control + 1;
      if (packed.size() - at < count || size - data.size() < count) return std::nullopt;
      data.append(packed.substr(at, count));
      at += count;
      continue;
    }
    std::size_t count = control >> 5U;
    if (count == 7) {
      if (at == packed.size()) return std::nullopt;
      count += byte();
    }
    if (at == packed.size()) return std::nullopt;
    const std::size_t distance = ((control & 31U) << 8U | byte()) + 1;
    count += 2;
    if (distance > data.size() || size - data.size() < count) return std::nullopt;
    for (std::size_t k = 0; k < count; ++k) data.push_back(data[data.size() - distance]);
  }
  if (data.size() != size) return std::nullopt;
  return data;
}

}  // namespace gdtslam
