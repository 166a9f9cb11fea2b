// Text files of blank-separated numbers, a fixed number to a row; comments and blank lines are skipped.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "field_cursor.hpp"
#include "gdtslam/core/error.hpp"
#include "line_reader.hpp"

namespace gdtslam {

/// Calls `take(values, position)`, which may keep them, for each row of N finite numbers. Throws InputError with file
/// and line.
template <std::size_t N, class Take>
void for_each_row(std::unique_ptr<ByteSource> source, const std::string& name, const char* columns, Take take) {
  constexpr std::size_t kMaxRowBytes = 4096;
  LineReader lines(gunzip_if_packed(std::move(source), name), kMaxRowBytes);
  std::uint64_t kept_bytes = 0;
  while (const std::optional<TextLine> line = lines.next()) {
    const FilePosition position{name, line->number};
    FieldCursor cursor(line->text);
    if (cursor.at_end() || line->text[line->text.find_first_not_of(" \t\r")] == '#') {
      continue;
    }
    std::array<double, N> values{};
    try {
      if (line->is_too_long) {
        throw MalformedLine("is too long");
      }
      for (double& value : values) {
        value = cursor.finite("numbers");
      }
      if (!cursor.at_end()) {
        throw MalformedLine("has more numbers than that");
      }
    } catch (const MalformedLine& error) {
      throw InputError(position, fmt::format("the row {}; a row is `{}`", error.what(), columns));
    }
    take(values, position);
    kept_bytes += sizeof(values);
    check_kept_bytes(kept_bytes, lines.source().bytes_from_file(), name);
  }
  if (const std::string defect = lines.source().defect(); !defect.empty()) {
    throw InputError({name, 0}, defect);
  }
}

}  // namespace gdtslam
