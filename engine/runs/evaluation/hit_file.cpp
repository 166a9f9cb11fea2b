#include "hit_file.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <string_view>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kDoubles = 6;
constexpr std::size_t kWords = 3;
constexpr std::size_t kRowBytes = 8 * kDoubles + 4 * kWords;
constexpr std::string_view kVertices = "element vertex ";

// The header line by line, the number of rows apart.
constexpr std::array<std::string_view, 14> kHeader{"ply",
                                                   "format binary_little_endian 1.0",
                                                   "comment true hits of a simulated scan",
                                                   kVertices,
                                                   "property double x",
                                                   "property double y",
                                                   "property double z",
                                                   "property double elevation",
                                                   "property double time",
                                                   "property double range",
                                                   "property uint scan",
                                                   "property uint beam",
                                                   "property uint triangle",
                                                   "end_header"};

template <class Word>
Word word_at(const std::array<char, kRowBytes>& row, std::size_t begin) {
  Word word = 0;
  for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
    word |= static_cast<Word>(static_cast<unsigned char>(row[begin + byte])) << (8 * byte);
  }
  return word;
}

double double_at(const std::array<char, kRowBytes>& row, std::size_t column) {
  return std::bit_cast<double>(word_at<std::uint64_t>(row, 8 * column));
}

bool read_count(std::string_view line, std::uint64_t& count) {
  if (!line.starts_with(kVertices)) return false;
  line.remove_prefix(kVertices.size());
  const auto [end, code] = std::from_chars(line.data(), line.data() + line.size(), count);
  return code == std::errc{} && end == line.data() + line.size();
}

// A header's line is short; without an end the file is something else.
bool read_line(std::istream& file, std::string& line) {
  constexpr std::size_t kLongest = 80;
  line.clear();
  for (int c = file.get(); c != '\n'; c = file.get()) {
    if (c == std::char_traits<char>::eof() || line.size() == kLongest) return false;
    line += static_cast<char>(c);
  }
  return true;
}

}  // namespace

HitReader::HitReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw FileError(path_, "cannot be opened");
  std::string line;
  for (std::size_t i = 0; i < kHeader.size(); ++i) {
    const bool fits =
        read_line(file_, line) && (kHeader[i] == kVertices ? read_count(line, hits_) : line == kHeader[i]);
    if (!fits) {
      throw InputError({path_, i + 1}, "is no file of true hits; `gdtslam simulate --truth-hits` writes one");
    }
  }
  const auto begin = file_.tellg();
  const auto bytes = static_cast<std::uint64_t>(file_.seekg(0, std::ios::end).tellg() - begin);
  file_.seekg(begin);
  if (!file_ || bytes % kRowBytes != 0 || bytes / kRowBytes != hits_) {
    throw InputError({path_, 0}, "has " + std::to_string(bytes) + " bytes of hits where its " + std::to_string(hits_) +
                                     " take " + std::to_string(kRowBytes) + " each; was it cut off?");
  }
}

std::optional<TrueHit> HitReader::next() {
  if (read_ == hits_) return std::nullopt;
  std::array<char, kRowBytes> row{};
  if (!file_.read(row.data(), static_cast<std::streamsize>(row.size()))) {
    throw FileError(path_,
                    "cannot be read after " + std::to_string(read_) + " of its " + std::to_string(hits_) + " hits");
  }
  ++read_;
  TrueHit hit{.place_m = {double_at(row, 0), double_at(row, 1), double_at(row, 2)},
              .stamp_s = double_at(row, 4),
              .range_m = double_at(row, 5),
              .scan = word_at<std::uint32_t>(row, 8 * kDoubles)};
  if (!hit.place_m.allFinite() || !std::isfinite(hit.stamp_s) || !(hit.range_m >= 0.0)) {
    throw InputError({path_, 0}, "hit " + std::to_string(read_) + " has a value that is not finite");
  }
  return hit;
}

}  // namespace gdtslam
