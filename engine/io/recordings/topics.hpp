// The topics of a recording as far as it was read: types, numbers of messages, rates. One table belongs to one thread;
// it knows at most kMostChannels channels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "containers/recording.hpp"
#include "messages.hpp"

namespace gdtslam {

/// A channel and the counts of its messages so far.
struct TopicChannel {
  RecordingChannel definition;
  MessageKind kind = MessageKind::kOther;
  std::uint64_t count = 0;
  double first_s = 0.0;  ///< receipt of the first message, and of the last one
  double last_s = 0.0;
};

class TopicTable {
 public:
  /// Returns null if the channel is already known, or there are too many.
  const TopicChannel* add(std::uint32_t number, const RecordingChannel& definition);
  [[nodiscard]] const TopicChannel* find(std::uint32_t number) const;
  /// Counts a message; returns its channel, null if unknown.
  const TopicChannel* count(const RecordingItem& message);
  /// "/scan (sensor_msgs/LaserScan, 1988 at 5.0 Hz), /rear (...)": each topic once, a dozen at most; "none".
  [[nodiscard]] std::string text(const std::function<bool(const TopicChannel&)>& is_told) const;

 private:
  std::map<std::uint32_t, TopicChannel> channels_;
};

inline bool has_scans(const TopicChannel& channel) {
  return channel.kind == MessageKind::kScan || channel.kind == MessageKind::kEchoScan;
}

}  // namespace gdtslam
