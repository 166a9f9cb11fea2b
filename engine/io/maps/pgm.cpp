#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "gdtslam/core/error.hpp"
#include "png.hpp"

namespace gdtslam {
namespace {

bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Reads the numbers of the header, with white space and comments between them.
class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  std::uint32_t number(std::string_view what, std::uint32_t max) {
    skip_space_and_comments();
    std::uint64_t value = 0;
    const std::size_t start = position_;
    for (; position_ < text_.size() && text_[position_] >= '0' && text_[position_] <= '9' && value <= max;
         ++position_) {
      value = value * 10 + static_cast<std::uint64_t>(text_[position_] - '0');
    }
    if (position_ == start || value == 0 || value > max) {
      throw InputError({name_, 0}, fmt::format("its PGM header has no {} from 1 to {}", what, max));
    }
    return static_cast<std::uint32_t>(value);
  }
  /// The bytes after the header and one white-space character.
  std::string_view rest() {
    if (position_ >= text_.size() || !is_space(text_[position_])) {
      throw InputError({name_, 0}, "its PGM header does not end in white space");
    }
    return text_.substr(position_ + 1);
  }

 private:
  void skip_space_and_comments() {
    while (position_ < text_.size() && (is_space(text_[position_]) || text_[position_] == '#')) {
      if (text_[position_] == '#') {
        position_ = std::min(text_.find('\n', position_), text_.size());
      } else {
        ++position_;
      }
    }
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t position_ = 2;  // after "P5"
};

}  // namespace

Grey8Image decode_pgm(std::span<const std::byte> data, const std::string& name) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  if (!text.starts_with("P5") || text.size() < 3 || !(is_space(text[2]) || text[2] == '#')) {
    throw InputError({name, 0}, "is no binary PGM image (P5)");
  }
  constexpr std::uint32_t kMaxSide = 0x7fffffff;
  HeaderReader header(text, name);
  Grey8Image image;
  image.width = header.number("width", kMaxSide);
  image.height = header.number("height", kMaxSide);
  image.max_value = header.number("maximum value", 255);
  const std::string_view pixels = header.rest();
  const std::uint64_t stated = std::uint64_t{image.width} * image.height;
  if (pixels.size() > stated) {
    throw InputError({name, 0}, fmt::format("states {} x {} pixels but holds {}; remove what follows them", image.width,
                                            image.height, pixels.size()));
  }
  if (pixels.size() != stated) {
    throw InputError({name, 0}, fmt::format("states {} x {} pixels but holds {}; is it cut off?", image.width,
                                            image.height, pixels.size()));
  }
  image.pixels.assign(pixels.begin(), pixels.end());
  return image;
}

}  // namespace gdtslam
