#include "lzf_packer.hpp"

#include <algorithm>
#include <cstddef>
#include <map>

namespace gdtslam::test {
namespace {

constexpr std::size_t kMostLiterals = 32;
constexpr std::size_t kMostLength = 264;  // 2 + 7 + 255
constexpr std::size_t kMostDistance = 8192;

char to_char(std::size_t value) { return static_cast<char>(static_cast<unsigned char>(value)); }

void put_literals(std::string& packed, std::string_view literals) {
  while (!literals.empty()) {
    const std::string_view run = literals.substr(0, kMostLiterals);
    packed += to_char(run.size() - 1);
    packed += run;
    literals.remove_prefix(run.size());
  }
}

void put_repeat(std::string& packed, std::size_t distance, std::size_t length) {
  const std::size_t high = (distance - 1) >> 8U;
  const std::size_t code = length - 2;
  packed += to_char(std::min<std::size_t>(code, 7) << 5U | high);
  if (code >= 7) packed += to_char(code - 7);
  packed += to_char((distance - 1) & 255U);
}

}  // namespace

std::string pack_lzf(std::string_view data) {
  std::string packed;
  std::map<std::string_view, std::size_t> last;
  std::size_t literals = 0;  // where those not yet put begin
  std::size_t at = 0;
  while (at + 3 <= data.size()) {
    const auto [found, is_new] = last.try_emplace(data.substr(at, 3), at);
    const std::size_t from = found->second;
    found->second = at;
    if (is_new || at - from > kMostDistance) {
      ++at;
      continue;
    }
    std::size_t length = 3;
    while (length < kMostLength && at + length < data.size() && data[from + length] == data[at + length]) ++length;
    put_literals(packed, data.substr(literals, at - literals));
    put_repeat(packed, at - from, length);
    at += length;
    literals = at;
  }
  put_literals(packed, data.substr(literals));
  return packed;
}

}  // namespace gdtslam::test
