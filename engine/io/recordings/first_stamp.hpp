// Stamps of a topic's messages. A header without a stamp has 0 there, and its message gets the time of its receipt; but
// a simulator's clock begins at 0, and then that is a time. The topic's second message tells which of them a first
// stamp of 0 is: it is a time where stamps went on from it as receipts did. Until then the first message waits.
// Seconds. Not thread-safe; one message is kept.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

namespace gdtslam {

/// Message: has stamp_s.
template <class Message>
class FirstStamp {
 public:
  /// Gives take(message, received_s, has_stamp) those whose stamps are known by now, in the order in which they came.
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

  /// Where no second message comes, or nobody can wait for it: a first stamp of 0 is none.
  template <class Take>
  void settle(const Take& take) {
    if (!first_) return;
    zero_ = Zero::kNone;
    give(std::exchange(first_, std::nullopt), take);
  }

  [[nodiscard]] bool is_waiting() const { return first_.has_value(); }

 private:
  /// Of a simulator's clock from that of receipts, which may be slower or faster, between two messages.
  static constexpr double kMostOff_s = 10.0;

  using Received = std::pair<Message, double>;
  /// What a stamp of 0 is.
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

}  // namespace gdtslam
