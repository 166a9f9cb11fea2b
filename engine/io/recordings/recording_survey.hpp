// Contents of a recording, collected while reading: its topics with rates, frames, clocks and numbers, the tree of its
// frames, and their use by the reader. Not thread-safe; memory is bounded: kMostSurveyed topics of each use and
// FrameTree::kMostFrames frames are kept, without overlong names.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/log_contents.hpp"
#include "messages.hpp"
#include "scan_assembler.hpp"
#include "topics.hpp"

namespace gdtslam {

/// Quantiles of a stream of numbers of any length from at most kMost of them: keeps every k-th, with k the least power
/// of two that gives few enough.
class EvenSample {
 public:
  static constexpr std::size_t kMost = 512;  // even
  void add(double value) {
    if (seen_++ % every_ != 0) return;
    if (values_.size() == kMost) {
      for (std::size_t k = 0; k < kMost / 2; ++k) values_[k] = values_[2 * k];
      values_.resize(kMost / 2);
      every_ *= 2;
    }
    values_.push_back(value);
  }
  [[nodiscard]] std::uint64_t seen() const { return seen_; }
  /// The kept number with that share of the others below it; 0 without numbers.
  [[nodiscard]] double quantile(double share) const {
    if (values_.empty()) return 0.0;
    std::vector<double> sorted = values_;
    const auto rank = static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1) + 0.5);
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(rank), sorted.end());
    return sorted[rank];
  }

 private:
  std::vector<double> values_;
  std::uint64_t seen_ = 0;
  std::uint64_t every_ = 1;
};

class RecordingSurvey {
 public:
  static constexpr std::size_t kMostSurveyed = 256;
  /// Call once for each channel.
  void add_channel(const RecordingChannel& channel);
  /// True if the bytes of its messages are needed: types for a map, and small types with a header.
  [[nodiscard]] static bool wants(const TopicChannel& channel);
  /// A message without bytes, or one that breaks its format, is only counted.
  void add(const TopicChannel& channel, const MessageBytes& message, double received_s);
  /// Topics and frames, without their uses.
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

/// The requested choice, and the topics that are used.
struct RecordingUses {
  const TopicChoice& choice;
  const std::string& odometry;                                    ///< empty: none, or transforms
  const std::string& crank;                                       ///< empty: none
  const std::map<std::string, std::size_t, std::less<>>& lasers;  ///< numbers by their topics
};

/// Fills in uses of topics and the reasons as text, lasers, odometry and clocks.
void tell_uses(const RecordingUses& uses, const ScanAssembler& assembler, LogContents& contents);

}  // namespace gdtslam
