#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "engine/io/decimal.hpp"
#include "engine/io/text_log.hpp"
#include "gdtslam/io/log.hpp"

namespace gdtslam {
namespace {

struct Sign {
  std::string_view begin;
  std::string_view fault;
};
constexpr std::array<Sign, 17> kSigns{{
    {"\x89PNG", "is a PNG picture, not a log"},
    {"\xff\xd8\xff", "is a JPEG picture, not a log"},
    {"P2", "is a PGM picture, not a log"},
    {"P5", "is a PGM picture, not a log"},
    {"PK\x03\x04", "is a ZIP archive, not a log; unpack it and give the log in it"},
    {"# .PCD", "is a PCD point cloud, not a log"},
    {"ply", "is a PLY file, not a log"},
    {"VERTEX_SE2", "is a g2o graph, not a log"},
    {"version https://git-lfs", "is a pointer of Git LFS, not the file itself; 'git lfs pull' fetches that"},
    {"%time,", "is text of 'rostopic echo -p', not a log; give the bag that it was read from"},
    {"header:", "is text of 'rostopic echo', not a log; give the bag that it was read from"},
    {"image:", "is the YAML file of a map, not a log; 'gdtslam localize' takes it"},
    {"resolution:", "is the YAML file of a map, not a log; 'gdtslam localize' takes it"},
    {"[", "is a JSON array, not a log; write each of its objects on a line of its own (jq -c '.[]')"},
    {"{", "is JSON over several lines, not a log; write each object on a line of its own (jq -c .)"},
    {"<", "is a page of HTML or XML, not a log"},
    {"%PDF", "is a PDF file, not a log"},
}};

/// A row of a TUM trajectory: stamp, position and quaternion.
bool is_tum_row(std::string_view line) {
  constexpr std::string_view kBetweenNumbers = " \t\r";
  std::size_t numbers = 0;
  for (std::size_t begin = 0; (begin = line.find_first_not_of(kBetweenNumbers, begin)) != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBetweenNumbers, begin), line.size());
    double value = 0.0;
    if (parse_double(line.data() + begin, line.data() + end, value) != line.data() + end) return false;
    ++numbers;
    begin = end;
  }
  return numbers == 8;
}

}  // namespace

std::string give_a_log() { return fmt::format("; give a {} log", kLogFormats); }

std::string fault_of_foreign_line(std::string_view line) {
  const auto sign =
      std::find_if(kSigns.begin(), kSigns.end(), [line](const Sign& s) { return line.starts_with(s.begin); });
  if (sign == kSigns.end()) return is_tum_row(line) ? "is a TUM trajectory, not a log" + give_a_log() : "";
  const bool says_what_to_do = sign->fault.find(';') != std::string_view::npos;
  return std::string(sign->fault) + (says_what_to_do ? "" : give_a_log());
}

}  // namespace gdtslam
