// Recordings: bags, MCAP files and the messages in them. A fuzzer guesses neither lengths nor checksums, so two targets
// make whole containers of what it does guess: the records.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "engine/io/little_endian.hpp"
#include "engine/io/recordings/messages.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "log_reading.hpp"

namespace gdtslam::fuzz {

template <class Open>
void drain_recording(const Open& open, std::span<const std::byte> data) {
  drain(open, data, false);
  drain(open, data, true);
  drain(open, data, true, true);
}

inline void read_bag(std::span<const std::byte> data) { drain_recording(open_bag, data); }
inline void read_mcap(std::span<const std::byte> data) { drain_recording(open_mcap, data); }
inline void read_sqlite_bag(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  const std::string file = folder.put("bag.db3", text_of(data));
  const auto open = [&file](const std::unique_ptr<ByteSource>& /*bytes*/, const std::string& /*name*/,
                            const ReadOptions& options) { return open_ros2_bag(file, options); };
  drain_recording(open, data);
}

/// A message: its first byte says which, its second one how it is encoded.
inline void read_cdr(std::span<const std::byte> data) {
  if (data.size() < 2) return;
  const MessageEncoding encoding = data[1] == std::byte{0} ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
  const MessageBytes message{.bytes = text_of(data.subspan(2)), .encoding = encoding};
  try {
    switch (std::to_integer<unsigned>(data[0]) % 6U) {
      case 0:
        require(read_scan(message).ranges_m.size() * sizeof(float) <= data.size());
        break;
      case 1:
        require(read_echo_scan(message).ranges_m.size() * sizeof(float) <= data.size());
        break;
      case 2:
        require(read_odometry(message).T_parent_child.is_finite());
        break;
      case 3:
        require(read_transforms(message).size() <= data.size());
        break;
      case 4:
        (void)read_joint(message, "");
        break;
      default:
        (void)read_number(message, "std_msgs/Int32");
        break;
    }
  } catch (const RecordingFault& fault) {
    require(is_one_line(fault.what()));
  }
}

namespace detail {

/// The records of an input: a byte each for what it is and for more about it, two for the length, then its content.
class RecordsIn {
 public:
  explicit RecordsIn(std::string_view input) : rest_(input) {}
  bool next() {
    constexpr std::size_t kHead = 4;
    if (rest_.size() < kHead) return false;
    op = static_cast<std::uint8_t>(rest_[0]);
    about = static_cast<std::uint8_t>(rest_[1]);
    const auto low = static_cast<std::uint8_t>(rest_[2]);
    const auto high = static_cast<std::uint8_t>(rest_[3]);
    const std::size_t length = std::min<std::size_t>(low + 256U * high, rest_.size() - kHead);
    content = rest_.substr(kHead, length);
    rest_.remove_prefix(kHead + length);
    return true;
  }
  std::uint8_t op = 0;
  std::uint8_t about = 0;
  std::string_view content;

 private:
  std::string_view rest_;
};

inline std::string whole64(std::uint64_t value) {
  std::string bytes;
  append_little_endian(bytes, value);
  return bytes;
}
inline std::string whole32(std::uint64_t value) {
  std::string bytes;
  append_little_endian(bytes, static_cast<std::uint32_t>(value));
  return bytes;
}

inline std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

inline std::string mcap_record(std::uint8_t op, std::string_view content) {
  return static_cast<char>(op) + whole64(content.size()) + std::string(content);
}

}  // namespace detail

/// An MCAP file of records, those marked in chunks, with lengths and checksums that hold.
inline std::string mcap_of(std::string_view input) {
  constexpr std::uint8_t kChunk = 6;
  constexpr std::uint8_t kDataEnd = 15;
  constexpr std::uint8_t kFooter = 2;
  std::string file = "\x89MCAP0\r\n";
  std::string chunk;
  const auto end_chunk = [&] {
    if (chunk.empty()) return;
    file += detail::mcap_record(kChunk, std::string(16, '\0') + detail::whole64(chunk.size()) +
                                            detail::whole32(detail::crc_of(chunk)) + detail::whole32(0) +
                                            detail::whole64(chunk.size()) + chunk);
    chunk.clear();
  };
  detail::RecordsIn records(input);
  while (records.next()) {
    const bool is_in_chunk = (records.about & 1U) != 0;
    if (!is_in_chunk || (records.about & 2U) != 0) end_chunk();
    (is_in_chunk ? chunk : file) += detail::mcap_record(records.op, records.content);
  }
  end_chunk();
  file += detail::mcap_record(kDataEnd, detail::whole32(detail::crc_of(file)));
  return file + detail::mcap_record(kFooter, std::string(20, '\0'));
}

/// A bag of records, each its kind, its connection and its data; those of connections are text lines "name=value", and
/// marked records stand in chunks.
inline std::string bag_of(std::string_view input) {
  constexpr std::uint8_t kChunk = 5;
  constexpr std::uint8_t kConnection = 7;
  const auto field = [](std::string_view text) { return detail::whole32(text.size()) + std::string(text); };
  const auto sized = [](const std::string& bytes) { return detail::whole32(bytes.size()) + bytes; };
  const auto op_field = [&](std::uint8_t op) { return field(std::string("op=") + static_cast<char>(op)); };
  std::string file = "#ROSBAG V2.0\n";
  file += sized(op_field(3) + field("index_pos=" + std::string(8, '\0')) + field("conn_count=" + std::string(4, '\0')) +
                field("chunk_count=" + std::string(4, '\0'))) +
          sized("");
  std::string chunk;
  const auto end_chunk = [&] {
    if (chunk.empty()) return;
    file += sized(op_field(kChunk) + field("compression=none") + field("size=" + detail::whole32(chunk.size()))) +
            sized(chunk);
    chunk.clear();
  };
  detail::RecordsIn records(input);
  while (records.next()) {
    const bool is_in_chunk = (records.about & 1U) != 0;
    if (!is_in_chunk || (records.about & 2U) != 0) end_chunk();
    std::string header = op_field(records.op) + field("conn=" + detail::whole32(records.about >> 2U));
    std::string data(records.content);
    if (records.op == kConnection) {
      data.clear();
      for (std::string_view rest = records.content; !rest.empty();) {
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        if (rest.starts_with("topic=")) header += field(rest.substr(0, end));
        data += field(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
    } else {
      header += field("time=" + std::string("\x01\0\0\0\0\0\0\0", 8));
    }
    (is_in_chunk ? chunk : file) += sized(header) + sized(data);
  }
  end_chunk();
  return file;
}

inline void read_mcap_records(std::span<const std::byte> data) { read_mcap(bytes_of(mcap_of(text_of(data)))); }
inline void read_bag_records(std::span<const std::byte> data) { read_bag(bytes_of(bag_of(text_of(data)))); }

/// The folder of a ROS 2 bag: its metadata.yaml and what that names.
inline void read_ros2_folder(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  constexpr std::array<std::string_view, 4> kNames{"metadata.yaml", "bag_0.db3", "bag_0.mcap", "bag_1.mcap"};
  put_files(folder, files_in(text_of(data), std::string(kNames[0])), kNames);
  for (const bool lenient : {false, true}) {
    expect_typed<UsageError, InputError, FileError>([lenient] {
      const std::unique_ptr<DescribedLog> reader = open_ros2_bag(folder.path(), {.lenient = lenient});
      while (const std::optional<LogRecord> record = reader->next()) check_record(*record);
    });
  }
}

inline constexpr std::array kRecordingTargets{
    FuzzTarget{"bag", read_bag, 14},
    FuzzTarget{"mcap", read_mcap, 5},
    FuzzTarget{"sqlite_bag", read_sqlite_bag, 2},
    FuzzTarget{"cdr", read_cdr, 6},
    FuzzTarget{"mcap_records", read_mcap_records, 2},
    FuzzTarget{"bag_records", read_bag_records, 2},
    FuzzTarget{"ros2_folder", read_ros2_folder, 3},
};

}  // namespace gdtslam::fuzz
