// Logs as text, and the senders of `live`.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "engine/io/logs/carmen.hpp"
#include "engine/io/tables/table_reader.hpp"
#include "log_reading.hpp"
#include "tools/gdtslam/live/input/whole_lines.hpp"

namespace gdtslam::fuzz {

inline void read_carmen_log(std::span<const std::byte> data) {
  drain(open_carmen, data, false);
  drain(open_carmen, data, true);
}

template <TableKind kind>
void read_table(std::span<const std::byte> data) {
  constexpr auto kOpen = [](std::unique_ptr<ByteSource> source, const std::string& name, const ReadOptions& options) {
    return open_table(kind, std::move(source), name, options);
  };
  drain(kOpen, data, false);
  drain(kOpen, data, true);
}

/// Senders that come and go at the socket of `live`: 0x1e ends a piece, 0x1d lets the sender go away. What the mapper
/// gets are the whole lines of all of them.
inline void read_senders(std::span<const std::byte> data) {
  constexpr char kGoesAway = '\x1d';
  constexpr char kEndOfPiece = '\x1e';
  WholeLines lines;
  std::string received;
  std::string expected;
  std::string of_sender;
  std::array<char, 97> target{};
  const auto take_all = [&] {
    while (!lines.is_empty()) {
      const std::size_t count = lines.take(target);
      require(count > 0 && count <= target.size());
      received.append(target.data(), count);
    }
  };
  std::string_view rest = text_of(data);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find_first_of("\x1d\x1e"), rest.size());
    lines.add(rest.substr(0, end));
    of_sender += rest.substr(0, end);
    const char mark = end < rest.size() ? rest[end] : kGoesAway;
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (mark == kEndOfPiece) {
      take_all();
      continue;
    }
    const std::size_t whole = of_sender.rfind('\n') + 1;  // 0 where there is none
    require(lines.drop_rest() == (whole < of_sender.size()));
    expected += of_sender.substr(0, whole);
    of_sender.clear();
  }
  take_all();
  expected += of_sender.substr(0, of_sender.rfind('\n') + 1);  // of one that is still there
  require(received == expected, "not the whole lines of the senders");
}

inline constexpr std::array kLogTargets{
    FuzzTarget{"carmen", read_carmen_log, 12},
    FuzzTarget{"csv", read_table<TableKind::kCsv>, 6},
    FuzzTarget{"jsonl", read_table<TableKind::kJsonLines>, 5},
    FuzzTarget{"senders", read_senders, 4},
};

}  // namespace gdtslam::fuzz
