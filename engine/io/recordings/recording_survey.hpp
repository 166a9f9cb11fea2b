// What a recording has, seen in passing: its topics with rates, frames, clocks and numbers, and the tree of its frames.
// What of it is used, its reader knows. Not thread-safe; memory is bounded: kMostSurveyed topics of each use and
// FrameTree::kMostFrames frames are kept, and of messages no names that are longer than any that people give.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "engine/io/log_contents.hpp"
#include "even_sample.hpp"
#include "messages.hpp"
#include "topics.hpp"

namespace gdtslam {

class RecordingSurvey {
 public:
  static constexpr std::size_t kMostSurveyed = 256;
  /// Once for each channel.
  void add_channel(const RecordingChannel& channel);
  /// Whether the bytes of its messages tell something: of the types that a map needs, and of small ones with a header.
  [[nodiscard]] static bool wants(const TopicChannel& channel);
  /// Without bytes it is only counted. A message that breaks its format is, too.
  void add(const TopicChannel& channel, const MessageBytes& message, double received_s);
  /// Topics and frames; all as if nothing were used.
  [[nodiscard]] LogContents contents() const;

 private:
  struct Topic {
    TopicContents contents;
    EvenSample delays_s;
  };
  struct Link {
    FrameLink link;
    Transform3 T_first;  ///< parent to child, in the first message
  };
  void look_into(Topic& topic, const TopicChannel& channel, const MessageBytes& message, double received_s);
  void add_transforms(Topic& topic, const MessageBytes& message, double received_s);
  static void add_number(TopicContents& topic, double value);
  static void add_header(Topic& topic, double stamp_s, const std::string& frame, double received_s);

  std::map<std::string, Topic, std::less<>> topics_;
  std::map<std::string, Link, std::less<>> links_;  ///< by child
  std::array<std::size_t, 5> kept_{};               ///< by TopicUse
  std::uint64_t left_out_ = 0;
};

}  // namespace gdtslam
