// What each fuzzer calls: a reader on bytes in memory. A typed error is a right answer; a crash, a leak, a hang or any
// other exception is not. tests/unit/io replays the corpus with the same functions under every compiler.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "engine/io/binary/log_copy.hpp"
#include "engine/io/binary/log_copy_records.hpp"
#include "engine/io/log_contents.hpp"
#include "engine/io/logs/carmen.hpp"
#include "engine/io/maps/pgm.hpp"
#include "engine/io/maps/png.hpp"
#include "engine/io/meshes/mesh_file.hpp"
#include "engine/io/recordings/messages.hpp"
#include "engine/io/recordings/recording_reader.hpp"
#include "engine/io/tables/table_reader.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/config.hpp"

namespace gdtslam::fuzz {
namespace detail {

/// A broken promise of the readers; ends the program so that the fuzzer sees it.
inline void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

inline bool is_one_line(const char* message) { return std::string_view(message).find('\n') == std::string_view::npos; }

inline void check_record(const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    require(std::isfinite(scan->scan.stamp_s) && (!scan->T_odom_base || scan->T_odom_base->is_finite()));
    for (const float range_m : scan->scan.ranges_m) {
      require(range_m >= 0.0F);  // neither negative nor not a number
    }
  }
}

using OpenBytes = std::unique_ptr<DescribedLog> (*)(std::span<const std::byte>, const std::string&, const ReadOptions&);

inline void check_contents(const LogContents& contents) {
  require(contents.topics.size() <= 256 && contents.frames.size() <= 4096 && contents.lines.size() <= 65);
  for (const TopicContents& topic : contents.topics) {
    require(topic.frames.size() <= 4 && topic.joints.size() <= 16 && topic.rate_hz() >= 0.0);
    require(!topic.delay ||
            (topic.delay->low_s <= topic.delay->median_s && topic.delay->median_s <= topic.delay->high_s));
  }
}

inline void drain(OpenBytes open, std::span<const std::byte> data, bool lenient, bool survey = false) {
  try {
    const auto reader = open(data, "fuzz", {.lenient = lenient, .survey = survey});
    while (const std::optional<LogRecord> record = reader->next()) {
      check_record(*record);
    }
    require(reader->warnings().size() <= 65);
    check_contents(reader->contents());
  } catch (const UsageError& error) {  // several topics
    require(is_one_line(error.what()));
  } catch (const InputError& error) {
    require(is_one_line(error.what()));
  }
}

inline void check_point(const CloudPoint& p) {
  require(std::isfinite(p.x_m) && std::isfinite(p.y_m) && std::isfinite(p.z_m) && std::isfinite(p.elevation_rad) &&
          std::isfinite(p.stamp_s));
}

}  // namespace detail

inline void read_carmen(std::span<const std::byte> data) {
  detail::drain(open_carmen, data, false);
  detail::drain(open_carmen, data, true);
}

inline void read_bag(std::span<const std::byte> data) {
  detail::drain(open_bag, data, false);
  detail::drain(open_bag, data, true);
  detail::drain(open_bag, data, true, true);
}

inline void read_mcap(std::span<const std::byte> data) {
  detail::drain(open_mcap, data, false);
  detail::drain(open_mcap, data, true);
  detail::drain(open_mcap, data, true, true);
}

inline void read_sqlite_bag(std::span<const std::byte> data) {
  detail::drain(open_sqlite_bag, data, false);
  detail::drain(open_sqlite_bag, data, true);
  detail::drain(open_sqlite_bag, data, true, true);
}

/// A message: its first byte says which, its second one how it is encoded.
inline void read_cdr(std::span<const std::byte> data) {
  if (data.size() < 2) return;
  const MessageEncoding encoding = data[1] == std::byte{0} ? MessageEncoding::kRos1 : MessageEncoding::kCdr;
  const MessageBytes message{.bytes = {reinterpret_cast<const char*>(data.data()) + 2, data.size() - 2},
                             .encoding = encoding};
  try {
    switch (std::to_integer<unsigned>(data[0]) % 6U) {
      case 0:
        detail::require(read_scan(message).ranges_m.size() * sizeof(float) <= data.size());
        break;
      case 1:
        detail::require(read_echo_scan(message).ranges_m.size() * sizeof(float) <= data.size());
        break;
      case 2:
        detail::require(read_odometry(message).T_parent_child.is_finite());
        break;
      case 3:
        detail::require(read_transforms(message).size() <= data.size());
        break;
      case 4:
        (void)read_joint(message, "");
        break;
      default:
        (void)read_number(message, "std_msgs/Int32");
        break;
    }
  } catch (const RecordingFault& fault) {
    detail::require(detail::is_one_line(fault.what()));
  }
}

inline void read_csv(std::span<const std::byte> data) {
  constexpr auto kOpen = [](std::span<const std::byte> bytes, const std::string& name, const ReadOptions& options) {
    return open_table(TableKind::kCsv, bytes, name, options);
  };
  detail::drain(kOpen, data, false);
  detail::drain(kOpen, data, true);
}

inline void read_json_lines(std::span<const std::byte> data) {
  constexpr auto kOpen = [](std::span<const std::byte> bytes, const std::string& name, const ReadOptions& options) {
    return open_table(TableKind::kJsonLines, bytes, name, options);
  };
  detail::drain(kOpen, data, false);
  detail::drain(kOpen, data, true);
}

/// A copy of a log with its checksums, and a frame within them, which a fuzzer could not guess: its records read back
/// as themselves, and after the first fault nothing is read.
inline void read_log_copy(std::span<const std::byte> data) {
  detail::drain(open_log_copy, data, false);
  detail::drain(open_log_copy, data, true);
  const std::string name = "fuzz";
  try {
    BytesIn frame({reinterpret_cast<const char*>(data.data()), data.size()}, name);
    RecordCoder coder;
    while (frame.left() > 0) {
      const LogRecord record = coder.record_from(frame);
      detail::check_record(record);
      const std::string bytes = record_bytes(record);
      BytesIn again(bytes, name);
      detail::require(record_bytes(RecordCoder().record_from(again)) == bytes && again.left() == 0);
    }
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
  try {
    BytesIn frame({reinterpret_cast<const char*>(data.data()), data.size()}, name);
    detail::require(end_from(frame).warnings.size() <= 128);
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
}

inline void read_config(std::span<const std::byte> data) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  MapperConfig config;
  const std::vector<Option> options = option_table(config);
  try {
    read_config_text(text, "fuzz", options);
    detail::require(violations(options).empty());
    MapperConfig again;
    const std::vector<Option> options_again = option_table(again);
    const std::string written = config_text(options);
    read_config_text(written, "written", options_again);
    detail::require(config_text(options_again) == written);
  } catch (const ConfigError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
}

inline void read_map_image(std::span<const std::byte> data) {
  try {
    const Grey8Image image = decode_pgm(data, "fuzz");
    detail::require(image.pixels.size() == std::size_t{image.width} * image.height &&
                    image.pixels.size() < data.size());
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
}

inline void read_trajectory(std::span<const std::byte> data) {
  try {
    for (const StampedPose& pose : read_tum(data, "fuzz")) {
      detail::require(pose.T_map_base.is_finite());
    }
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
}

inline void read_distance_image(std::span<const std::byte> data) {
  try {
    constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 22U;
    const Grey16Image image = decode_png_grey16(data, "fuzz", kMaxPixels);
    detail::require(image.pixels.size() == std::size_t{image.width} * image.height);
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
  try {
    constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 22U;
    const Grey8Image image = decode_png_grey8(data, "fuzz", kMaxPixels);
    detail::require(image.pixels.size() == std::size_t{image.width} * image.height);
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
}

/// PLY and PCD: which it is stands in the first line, so each has its corpus.
inline void read_cloud_file(std::span<const std::byte> data) {
  try {
    CloudReader reader(data, "fuzz");
    std::uint64_t points = 0;
    for (Cloud piece = reader.next(100); !piece.empty(); piece = reader.next(100)) {
      detail::require(piece.size() <= 100);
      for (const CloudPoint& point : piece) detail::check_point(point);
      points += piece.size();
    }
    detail::require(points + reader.skipped() == reader.header().points);
  } catch (const InputError& error) {
    detail::require(detail::is_one_line(error.what()));
  }
}

/// The same bytes as every format of meshes, because the name tells which it is.
inline void read_mesh_file(std::span<const std::byte> data) {
  for (const char* name : {"fuzz.obj", "fuzz.stl", "fuzz.ply"}) {
    try {
      const MeshFile mesh = read_mesh(data, name, {.max_triangles = 10'000});
      detail::require(!mesh.triangles.empty() && mesh.triangles.size() <= 10'000 && mesh.vertices.size() <= 30'000);
      for (const std::array<std::uint32_t, 3>& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) detail::require(corner < mesh.vertices.size());
      }
      for (const std::array<float, 3>& v : mesh.vertices) {
        detail::require(std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]));
      }
    } catch (const InputError& error) {
      detail::require(detail::is_one_line(error.what()));
    }
  }
}

}  // namespace gdtslam::fuzz
