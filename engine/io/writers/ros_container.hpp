// A file of ROS 2 messages, as the records of a log are written to it. One object belongs to one thread.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "ros_messages.hpp"

namespace gdtslam {

class RosContainer {
 public:
  RosContainer() = default;
  RosContainer(const RosContainer&) = delete;
  RosContainer& operator=(const RosContainer&) = delete;
  virtual ~RosContainer() = default;
  /// The number by which add() knows it. Who plays a latched topic gives its last message to every late listener.
  virtual std::uint32_t add_channel(const std::string& topic, RosType type, bool is_latched) = 0;
  /// The message as it is, with the time when it came. Throws FileError, as finish() does.
  virtual void add(std::uint32_t channel, std::int64_t received_ns, std::string_view message) = 0;
  virtual void finish() = 0;
  [[nodiscard]] virtual std::uint64_t bytes() const = 0;
};

/// How ROS 2 names the quality of service of a topic: reliable; latched ones keep their last message.
std::string ros2_service_quality(bool is_latched);

/// Little endian, on every host.
template <class Whole>
void append_whole(std::string& bytes, Whole value) {
  for (std::size_t k = 0; k < sizeof(Whole); ++k) {
    bytes += static_cast<char>((static_cast<std::uint64_t>(value) >> (8U * k)) & 0xffU);
  }
}

}  // namespace gdtslam
