// The interface of the containers of recorded messages: channels and messages in the order of the file, without going
// back if the format allows it. One recording belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gdtslam {

/// The longest message that is read; memory grows with the bytes that arrive, never with a number of the file.
inline constexpr std::size_t kMostMessageBytes = std::size_t{16} << 20U;
/// The longest header of a record, and the longest name of a topic or a type.
inline constexpr std::size_t kMostHeaderBytes = std::size_t{1} << 16U;
/// Limit on the channels known at a time.
inline constexpr std::size_t kMostChannels = 65536;

/// A fault of a recording, without its name and the place.
class RecordingFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// The recording ends in the middle of something.
class RecordingCut : public RecordingFault {
 public:
  using RecordingFault::RecordingFault;
};

/// The serialisation of a message.
enum class MessageEncoding : std::uint8_t { kOther, kRos1, kCdr };

/// Type and encoding of the messages of a topic. A topic may have several channels.
struct RecordingChannel {
  std::string topic;
  std::string type;           ///< pkg/Type or pkg/msg/Type
  std::string md5{};          ///< sum of the type's definition, if the container has it
  std::string encoding_name;  ///< name in the container
  MessageEncoding encoding = MessageEncoding::kOther;
};

/// A channel or a message.
struct RecordingItem {
  std::uint32_t channel = 0;
  std::optional<RecordingChannel> definition{};  ///< set for a channel; a message has none
  double received_s = 0.0;                       ///< for a message: time of recording, seconds since 1970
  std::string_view bytes{};                      ///< for a wanted message; valid until the next call
};

class Recording {
 public:
  /// True if the bytes of a channel's messages are wanted; others are skipped.
  using Wanted = std::function<bool(std::uint32_t channel)>;
  using Warn = std::function<void(std::string_view kind, const std::string& detail)>;

  Recording() = default;
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  virtual ~Recording() = default;
  /// The next channel or message; none at the end. Throws RecordingCut, or RecordingFault for damage; then nothing more
  /// can be read.
  virtual std::optional<RecordingItem> next(const Wanted& wanted, const Warn& warn) = 0;
  /// The current place of the reading, for messages: "before byte 120".
  [[nodiscard]] virtual std::string place() const = 0;
  /// Share of the input consumed, 0 to 1; negative when unknown.
  [[nodiscard]] virtual double progress() const = 0;
  /// The defect at the end of a packed input, else empty; known at the end.
  [[nodiscard]] virtual std::string defect() const { return {}; }
};

}  // namespace gdtslam
