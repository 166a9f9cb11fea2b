// Lines and raw bytes of one input (a cloud or a mesh), in turn, with a bound on both. One input belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/io/line_reader.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {

class CloudInput {
 public:
  static constexpr std::size_t kMostLineBytes = 65536;
  static constexpr std::size_t kMostBytes = 65536;

  CloudInput(std::unique_ptr<ByteSource> source, std::string name)
      : lines_(std::move(source), kMostLineBytes), name_(std::move(name)) {}

  /// The next line without its end; none at the end of the input. Throws InputError for a line that is too long.
  std::optional<std::string_view> line() {
    const std::optional<TextLine> line = lines_.next();
    if (!line) return std::nullopt;
    line_number_ = line->number;
    if (!line->is_too_long) return line->text;
    throw InputError({name_, line_number_}, "the line is longer than 64 KiB: is this the right file, and is it whole?");
  }
  /// The next `count` bytes (at most kMostBytes), valid until the next call; nullptr if the input ends before.
  const char* bytes(std::size_t count) { return lines_.bytes(count); }
  /// The same without consuming them.
  const char* peek(std::size_t count) { return lines_.peek_bytes(count); }
  /// Up to `most` available bytes; empty at the end.
  std::string_view some(std::size_t most) { return lines_.some(most); }
  [[nodiscard]] std::uint64_t line_number() const { return line_number_; }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// The defect at the end of the input, known once the end was reached.
  [[nodiscard]] std::string defect() const { return lines_.source().defect(); }
  [[nodiscard]] std::uint64_t bytes_from_file() const { return lines_.source().bytes_from_file(); }

 private:
  LineReader lines_;
  std::string name_;
  std::uint64_t line_number_ = 0;
};

}  // namespace gdtslam
