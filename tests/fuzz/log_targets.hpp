// Logs as text, their copies, and the senders of `live`.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "engine/io/logs/carmen.hpp"
#include "engine/io/logs/log_signs.hpp"
#include "engine/io/tables/table_reader.hpp"
#include "engine/io/writers/table_log.hpp"
#include "log_reading.hpp"
#include "tools/gdtslam/live/input/whole_lines.hpp"

namespace gdtslam::fuzz {

inline void read_carmen_log(std::span<const std::byte> data) {
  constexpr OpenBytes kOpen = open_carmen;
  drain(kOpen, data, false);
  drain(kOpen, data, true);
}

inline void read_csv(std::span<const std::byte> data) {
  constexpr auto kOpen = [](std::span<const std::byte> bytes, const std::string& name, const ReadOptions& options) {
    return open_table(TableKind::kCsv, bytes, name, options);
  };
  drain(kOpen, data, false);
  drain(kOpen, data, true);
}

inline void read_json_lines(std::span<const std::byte> data) {
  constexpr auto kOpen = [](std::span<const std::byte> bytes, const std::string& name, const ReadOptions& options) {
    return open_table(TableKind::kJsonLines, bytes, name, options);
  };
  drain(kOpen, data, false);
  drain(kOpen, data, true);
}

/// Records as lines of JSON, and what ended the reading.
struct ReadLog {
  std::vector<std::string> records;
  std::string error;
  bool has_scan = false;
  friend bool operator==(const ReadLog&, const ReadLog&) = default;
};

/// As a log comes from a pipe: as many bytes at a time as `pieces` says, in turn.
inline ReadLog read_in_pieces(std::string_view bytes, std::span<const std::size_t> pieces, bool lenient) {
  ReadLog log;
  std::size_t piece = 0;
  const auto read = [&](std::span<char> target) {
    const std::size_t most = pieces.empty() ? bytes.size() : std::max<std::size_t>(pieces[piece++ % pieces.size()], 1);
    const std::size_t count = std::min({target.size(), bytes.size(), most});
    std::copy_n(bytes.data(), count, target.data());
    bytes.remove_prefix(count);
    return count;
  };
  expect_typed<UsageError, InputError>([&] {
    try {
      const std::unique_ptr<LogReader> reader = open_log_of_bytes(read, "fuzz", {.lenient = lenient});
      while (const std::optional<LogRecord> record = reader->next()) {
        check_record(*record);
        log.records.push_back(json_line(*record));
        log.has_scan = log.has_scan || std::holds_alternative<ScanRecord>(*record);
      }
      for (const LogReader::Warning& warning : reader->warnings()) log.error += warning.kind + ": " + warning.first;
    } catch (const Error& error) {
      log.error = error.what();
      throw;
    }
  });
  return log;
}

/// Of damaged packed data one may have more than the other: what an unpacker finds ahead of the records is an error.
inline bool is_same_log(const ReadLog& a, const ReadLog& b) {
  if (a == b) return true;
  const auto is_damaged = [](const ReadLog& log) { return log.error.find(": damaged ") != std::string::npos; };
  const auto both = static_cast<std::ptrdiff_t>(std::min(a.records.size(), b.records.size()));
  return (is_damaged(a) || is_damaged(b)) && std::equal(a.records.begin(), a.records.begin() + both, b.records.begin());
}

/// What a sender sends, in pieces: the first bytes are their sizes, up to a 0. It makes no difference where a piece
/// ends, whatever the format, packed or not. What a scan is read of is a recording, in whose place no result is put.
inline void read_stream(std::span<const std::byte> data) {
  std::vector<std::size_t> pieces;
  while (pieces.size() < data.size() && data[pieces.size()] != std::byte{0}) {
    pieces.push_back(std::to_integer<std::size_t>(data[pieces.size()]));
  }
  const std::string_view bytes = text_of(data.subspan(std::min(pieces.size() + 1, data.size())));
  for (const bool lenient : {false, true}) {
    require(is_same_log(read_in_pieces(bytes, pieces, lenient), read_in_pieces(bytes, {}, lenient)),
            "a log reads otherwise in pieces");
  }
  static const ScratchFolder folder;
  require(is_recording(folder.put("log", bytes)) || !read_in_pieces(bytes, {}, false).has_scan,
          "a log that is not taken for a recording");
}

/// Senders that come and go at the socket of `live`: 0x1e ends a piece, 0x1d lets the sender go away. What the mapper
/// gets are the whole lines of all of them, and reads as a log of these lines does.
inline void read_senders(std::span<const std::byte> data) {
  constexpr char kGoesAway = '\x1d';
  constexpr char kEndOfPiece = '\x1e';
  WholeLines lines;
  std::string received;
  std::string expected;
  std::string of_sender;
  std::array<char, 97> target{};
  std::vector<std::size_t> pieces;
  const auto take_all = [&] {
    while (!lines.is_empty()) {
      const std::size_t count = lines.take(target);
      require(count > 0 && count <= target.size());
      received.append(target.data(), count);
      pieces.push_back(count);
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
  for (const bool lenient : {false, true}) {
    require(is_same_log(read_in_pieces(received, pieces, lenient), read_in_pieces(received, {}, lenient)));
  }
}

inline constexpr std::array kLogTargets{
    FuzzTarget{"carmen", read_carmen_log, 12}, FuzzTarget{"csv", read_csv, 6},
    FuzzTarget{"jsonl", read_json_lines, 5},   FuzzTarget{"stream", read_stream, 4},
    FuzzTarget{"senders", read_senders, 4},
};

}  // namespace gdtslam::fuzz
