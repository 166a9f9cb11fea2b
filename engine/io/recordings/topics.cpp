#include "topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/io/message_text.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostTopicsTold = 12;
constexpr std::size_t kMostNameTold = 80;

std::string told_topic(const TopicChannel& topic) {
  std::string text = fmt::format("{} ({}", one_line(topic.definition.topic, kMostNameTold),
                                 one_line(short_type(topic.definition.type), kMostNameTold));
  if (topic.definition.encoding == MessageEncoding::kOther) {
    const std::string& name = topic.definition.encoding_name;
    text += fmt::format(" as {}, which is not read", name.empty() ? "nothing stated" : one_line(name, kMostNameTold));
  }
  text += fmt::format(", {}", topic.count);
  const double duration_s = topic.last_s - topic.first_s;
  if (topic.count > 1 && duration_s > 0.0) {
    text += fmt::format(" at {:.1f} Hz", static_cast<double>(topic.count - 1) / duration_s);
  }
  return text + ")";
}

}  // namespace

const TopicChannel* TopicTable::add(std::uint32_t number, const RecordingChannel& definition) {
  if (channels_.size() >= kMostChannels || channels_.contains(number)) return nullptr;
  return &channels_.emplace(number, TopicChannel{.definition = definition, .kind = message_kind(definition)})
              .first->second;
}

const TopicChannel* TopicTable::find(std::uint32_t number) const {
  const auto found = channels_.find(number);
  return found == channels_.end() ? nullptr : &found->second;
}

const TopicChannel* TopicTable::count(const RecordingItem& message) {
  const auto found = channels_.find(message.channel);
  if (found == channels_.end()) return nullptr;
  TopicChannel& channel = found->second;
  if (channel.count++ == 0) channel.first_s = message.received_s;
  channel.last_s = message.received_s;
  return &channel;
}

std::string TopicTable::text(const std::function<bool(const TopicChannel&)>& is_told) const {
  std::map<std::string, TopicChannel> by_name;
  for (const auto& [number, channel] : channels_) {
    if (!is_told(channel)) continue;
    const auto [known, is_new] = by_name.emplace(channel.definition.topic, channel);
    if (is_new || channel.count == 0) continue;
    TopicChannel& topic = known->second;
    topic.first_s = topic.count == 0 ? channel.first_s : std::min(topic.first_s, channel.first_s);
    topic.last_s = std::max(topic.last_s, channel.last_s);
    topic.count += channel.count;
  }
  std::string text;
  std::size_t told = 0;
  for (const auto& [name, topic] : by_name) {
    if (told++ == kMostTopicsTold) return text + " and others";
    text += (text.empty() ? "" : ", ") + told_topic(topic);
  }
  return text.empty() ? "none" : text;
}

}  // namespace gdtslam
