// Stamps of a topic's messages. A header without a stamp has 0, and its message gets its time of receipt; but a
// simulator's clock begins at 0, and then 0 is a time. The topic's second message decides about a first stamp of 0: it
// is a time if stamps advanced from it as receipts did. Until then the first message waits. Seconds. Not thread-safe;
// one message is kept.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace gdtslam {

/// Message: has stamp_s.
template <class Message>
class FirstStamp {
 public:
  /// Calls take(message, received_s, has_stamp) for messages with known stamps, in the order of arrival.
  template <class Take>
  void add(Message message, double received_s, const Take& take) {
    if (zero_ == Zero::kUnknown && first_) {
      const double off_s = message.stamp_s - (received_s - first_->second);
      zero_ = message.stamp_s != 0.0 && std::fabs(off_s) < kMostOff_s ? Zero::kTime : Zero::kNone;
      give(std::exchange(first_, std::nullopt), take);
    } else if (zero_ == Zero::kUnknown && message.stamp_s != 0.0) {
      zero_ = Zero::kNone;
    } else if (zero_ == Zero::kUnknown && received_s != 0.0) {
      first_.emplace(std::move(message), received_s);
      return;
    }
    give(std::pair(std::move(message), received_s), take);
  }

  /// Call if no second message comes, or nobody can wait for it: a first stamp of 0 then means no stamp.
  template <class Take>
  void settle(const Take& take) {
    if (!first_) return;
    zero_ = Zero::kNone;
    give(std::exchange(first_, std::nullopt), take);
  }

  [[nodiscard]] bool is_waiting() const { return first_.has_value(); }

 private:
  /// The largest difference between a simulator's clock, which may run slower or faster, and the clock of receipts
  /// between two messages.
  static constexpr double kMostOff_s = 10.0;

  using Received = std::pair<Message, double>;
  /// The meaning of a stamp of 0.
  enum class Zero : std::uint8_t { kUnknown, kNone, kTime };

  template <class Take>
  void give(std::optional<Received> received, const Take& take) {
    auto& [message, received_s] = *received;
    const bool has_stamp = message.stamp_s != 0.0 || received_s == 0.0 || zero_ == Zero::kTime;
    if (!has_stamp) message.stamp_s = received_s;
    take(std::move(message), received_s, has_stamp);
  }

  std::optional<Received> first_;
  Zero zero_ = Zero::kUnknown;
};

/// The clock of one topic, relative to the times of receipt; so the clocks of two topics can be compared. Keeps at most
/// kMostSamples numbers.
class TopicClock {
 public:
  static constexpr std::size_t kMostSamples = 64;
  /// Messages of one clock are received within this time after their stamps.
  static constexpr double kMostDelay_s = 1.0;

  /// `duration_s`: least time from the stamp of a message to its sending.
  void add(double received_s, double stamp_s, double duration_s) {
    if (delays_s_.size() < kMostSamples) delays_s_.push_back(received_s - stamp_s - duration_s);
  }
  [[nodiscard]] bool is_known() const { return !delays_s_.empty(); }
  /// Receipt minus stamp of the message that was received fastest, because the receiver's delays vary and only add. A
  /// value far from the median is a wrong stamp and does not count.
  [[nodiscard]] double offset_s() const {
    std::vector<double> sorted = delays_s_;
    std::sort(sorted.begin(), sorted.end());
    const double median_s = sorted[sorted.size() / 2];
    return *std::find_if(sorted.begin(), sorted.end(),
                         [median_s](double delay_s) { return delay_s > median_s - kMostDelay_s; });
  }

 private:
  std::vector<double> delays_s_;
};

}  // namespace gdtslam
