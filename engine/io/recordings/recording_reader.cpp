#include "recording_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "containers/chunk.hpp"
#include "containers/mcap.hpp"
#include "containers/ros1_bag.hpp"
#include "containers/ros2_folder.hpp"
#include "containers/sqlite_bag.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/scan_sequence.hpp"
#include "engine/io/warning_counter.hpp"
#include "gdtslam/core/error.hpp"
#include "messages.hpp"
#include "recording_survey.hpp"
#include "scan_assembler.hpp"
#include "topics.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kAllTopics = "all";

/// The name of a topic in recordings, with a slash before.
std::string topic_name(const std::string& text) {
  return text.empty() || text.starts_with('/') || text == kAllTopics ? text : "/" + text;
}

ReadOptions with_topic_names(ReadOptions options) {
  TopicChoice& topics = options.topics;
  for (std::string& topic : topics.scans) topic = topic_name(topic);
  topics.odometry = topic_name(topics.odometry);
  topics.crank = topic_name(topics.crank);
  for (TopicMount& mount : topics.mounts) mount.topic = topic_name(mount.topic);
  if (std::find(topics.scans.begin(), topics.scans.end(), kAllTopics) != topics.scans.end()) {
    topics.scans.assign(1, std::string(kAllTopics));
  }
  return options;
}

/// Opens the container of a recording. Throws RecordingFault if it is none.
using RecordingMaker = std::function<std::unique_ptr<Recording>()>;

class RecordingReader final : public DescribedLog {
 public:
  RecordingReader(const RecordingMaker& make, std::string_view format, std::string name, const ReadOptions& options)
      : format_(format),
        name_(std::move(name)),
        options_(with_topic_names(options)),
        recording_(opened(make)),
        assembler_(options_, [this](std::string_view kind, const std::string& detail) { warn(kind, detail); }) {
    const std::size_t colon = options_.topics.crank.find(':');
    crank_topic_ = options_.topics.crank.substr(0, colon);
    if (colon != std::string::npos) joint_ = options_.topics.crank.substr(colon + 1);
    if (options_.survey) survey_.emplace();
  }

  std::optional<LogRecord> next() override {
    while (true) {
      if (std::optional<LogRecord> record = assembler_.next(is_over_)) {
        if (const auto* const scan = std::get_if<ScanRecord>(&*record)) check(*scan);
        return record;
      }
      if (is_over_) break;
      const std::optional<RecordingItem> item = next_item();
      item ? take(*item) : void(is_over_ = true);
    }
    finish();
    return std::nullopt;
  }
  [[nodiscard]] double progress() const override { return recording_->progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_.list(); }
  [[nodiscard]] LogContents contents() const override {
    LogContents contents = survey_ ? survey_->contents() : LogContents{};
    contents.format = format_;
    contents.is_recording = true;
    tell_uses({.choice = options_.topics, .odometry = odometry_topic_, .crank = crank_topic_, .lasers = lasers_},
              assembler_, contents);
    return contents;
  }

 private:
  std::unique_ptr<Recording> opened(const RecordingMaker& make) const {
    try {
      return make();
    } catch (const RecordingFault& fault) {
      throw InputError({name_, 0}, fault.what());
    }
  }

  void check(const ScanRecord& record) {
    if (sequences_.size() <= record.laser) sequences_.resize(record.laser + 1);
    sequences_[record.laser].check(record.scan,
                                   [this](std::string_view kind, const char* detail) { warn(kind, detail); });
    ++given_;
  }

  [[nodiscard]] bool is_chosen(const std::string& topic) const {
    const std::vector<std::string>& chosen = options_.topics.scans;
    if (chosen.empty()) return lasers_.empty() || lasers_.contains(topic);
    return chosen.front() == kAllTopics || std::find(chosen.begin(), chosen.end(), topic) != chosen.end();
  }

  [[nodiscard]] bool is_wanted(std::uint32_t number) const {
    const TopicChannel* const channel = topics_.find(number);
    if (channel == nullptr) return false;
    if (survey_ && RecordingSurvey::wants(*channel)) return true;
    const std::string& topic = channel->definition.topic;
    if (has_scans(*channel)) return is_chosen(topic);
    if (channel->kind == MessageKind::kOdometry) return odometry_topic_.empty() || topic == odometry_topic_;
    if (channel->kind == MessageKind::kTransforms) return true;
    return channel->kind != MessageKind::kOther && topic == crank_topic_;
  }

  /// Returns none at the end, and for a recording that was cut or, if tolerated, damaged.
  std::optional<RecordingItem> next_item() {
    try {
      return recording_->next([this](std::uint32_t channel) { return is_wanted(channel); },
                              [this](std::string_view kind, const std::string& detail) { warn(kind, detail); });
    } catch (const RecordingCut& cut) {
      warn("cut bag", cut.what() + std::string("; what came before counts"));
    } catch (const RecordingFault& fault) {
      if (!options_.lenient) {
        throw InputError({name_, 0},
                         fmt::format("{} {}; --lenient takes what is before it", fault.what(), recording_->place()));
      }
      warn("damaged recording", fault.what() + std::string("; what came before counts"));
    }
    return std::nullopt;
  }

  void take(const RecordingItem& item) {
    if (item.definition) {
      const bool is_new = topics_.add(item.channel, *item.definition) != nullptr;
      if (survey_ && is_new) survey_->add_channel(*item.definition);
      return;
    }
    try {
      const TopicChannel* const channel = topics_.count(item);
      if (channel == nullptr) throw RecordingFault("has a message of no known channel");
      take_message(*channel, item);
    } catch (const RecordingFault& fault) {
      if (!options_.lenient) {
        throw InputError({name_, 0},
                         fmt::format("{} {}; --lenient leaves out what is damaged", fault.what(), recording_->place()));
      }
      warn("malformed message", fault.what());
    }
  }

  void take_message(const TopicChannel& channel, const RecordingItem& item) {
    const std::string& topic = channel.definition.topic;
    const MessageEncoding encoding = channel.definition.encoding;
    const bool is_cdr = encoding == MessageEncoding::kCdr;
    const MessageBytes message{.bytes = is_cdr ? unpacked_message(item.bytes, unpacked_) : item.bytes,
                               .encoding = encoding};
    if (survey_) survey_->add(channel, message, item.received_s);
    if (has_scans(channel)) {
      take_scan(channel, message, item.received_s);
    } else if (channel.kind == MessageKind::kOdometry) {
      take_odometry(topic, message, item.received_s);
    } else if (channel.kind == MessageKind::kTransforms) {
      for (const TransformMessage& transform : read_transforms(message)) {
        const bool is_odometry =
            assembler_.add_transform(transform, item.received_s, topic.ends_with(kStaticTransforms));
        if (is_odometry && !options_.topics.odometry.empty()) odometry_topic_ = topic;
      }
    } else if (topic == crank_topic_ && channel.kind != MessageKind::kOther) {
      take_crank(channel, message, item.received_s);
    }
  }

  void take_odometry(const std::string& topic, const MessageBytes& message, double received_s) {
    if (!options_.topics.odometry.empty() && topic != options_.topics.odometry) return;
    if (odometry_topic_.empty()) odometry_topic_ = topic;
    if (topic == odometry_topic_) {
      assembler_.add_odometry(read_odometry(message), received_s);
    } else {
      warn("second odometry topic",
           fmt::format("{} is used, {} is not; --odom chooses", in_quotes(odometry_topic_), in_quotes(topic)));
    }
  }

  void take_crank(const TopicChannel& channel, const MessageBytes& message, double received_s) {
    const bool is_joint = channel.kind == MessageKind::kJoints;
    if (!is_joint && !joint_.empty()) {
      throw UsageError(fmt::format("{0}: {1} has numbers and no joint {2}; give {1} alone", name_,
                                   in_quotes(crank_topic_), in_quotes(joint_)));
    }
    const NumberMessage number = is_joint ? read_joint(message, joint_) : read_number(message, channel.definition.type);
    if (!std::isfinite(number.value)) throw RecordingFault("has a position of the crank that is not finite");
    const CrankOptions& crank = options_.crank;
    if (crank.step_rad == 0.0 && (crank.kind == CrankKind::kTilt) != is_joint) {
      throw UsageError(fmt::format("{}: {} {}", name_, in_quotes(crank_topic_),
                                   is_joint
                                       ? "has angles: state log.crank=tilt, or the angle of a tick as log.crank_step"
                                       : "has numbers: state the angle of one as log.crank_step, e.g. 1deg"));
    }
    ++crank_messages_;
    assembler_.add_crank(number, received_s, is_joint);
  }

  void take_scan(const TopicChannel& channel, const MessageBytes& message, double received_s) {
    const std::string& topic = channel.definition.topic;
    if (!is_chosen(topic)) {
      if (options_.topics.scans.empty() && !survey_) refuse_to_choose();
      return;
    }
    ScanMessage scan = channel.kind == MessageKind::kScan ? read_scan(message) : read_echo_scan(message);
    const auto known = lasers_.find(topic);
    const std::size_t laser =
        known != lasers_.end() ? known->second : lasers_.emplace(topic, assembler_.add_laser(topic)).first->second;
    assembler_.add_scan(laser, std::move(scan), received_s);
  }

  /// Counts the rest of the recording, so that the message lists the topics with their numbers.
  [[noreturn]] void refuse_to_choose() {
    try {
      while (const std::optional<RecordingItem> item =
                 recording_->next([](std::uint32_t) { return false; }, [](std::string_view, const std::string&) {})) {
        item->definition ? void(topics_.add(item->channel, *item->definition)) : void(topics_.count(*item));
      }
    } catch (const RecordingFault&) {  // counted up to the damage
    }
    throw UsageError(
        fmt::format("{}: has several topics with scans: {}; choose one with --topic, or all of them with "
                    "--topic all",
                    name_, topics_.text(has_scans)));
  }

  /// Checks that all named topics exist. One of several recordings may have only some of the lasers.
  void check_choice() {
    const TopicChoice& choice = options_.topics;
    for (const std::string& topic : choice.scans) {
      if (topic == kAllTopics || lasers_.contains(topic)) continue;
      throw MissingTopic(fmt::format("{}: has no scans in topic {}; those with scans are {}", name_, in_quotes(topic),
                                     topics_.text(has_scans)));
    }
    for (const TopicMount& mount : choice.mounts) {
      bool is_there = false;
      const std::string with_scans = topics_.text([&](const TopicChannel& channel) {
        is_there = is_there || (has_scans(channel) && channel.definition.topic == mount.topic);
        return has_scans(channel);
      });
      if (is_there) continue;
      warn("mount of a topic without scans",
           fmt::format("{} is stated; those with scans are {}", in_quotes(mount.topic), with_scans));
    }
    if (const OdometryChoice odometry(choice.odometry); odometry.is_transform() && odometry_topic_.empty()) {
      const std::string frame = odometry.frame.empty() ? "a frame called odom" : in_quotes(odometry.frame);
      const std::string base = odometry.base.empty() ? "" : " to " + in_quotes(odometry.base);
      throw MissingTopic(
          fmt::format("{}: has no transform from {}{}; its transforms are {}; --odom tf:FRAME:BASE names "
                      "the frames of the odometry",
                      name_, frame, base, assembler_.frames_text()));
    }
    if (!choice.odometry.empty() && odometry_topic_.empty()) {
      throw MissingTopic(fmt::format(
          "{}: has no odometry in topic {}; those with odometry are {}", name_, in_quotes(choice.odometry),
          topics_.text([](const TopicChannel& channel) { return channel.kind == MessageKind::kOdometry; })));
    }
    if (!choice.crank.empty() && crank_messages_ == 0) {
      throw MissingTopic(fmt::format("{}: has no numbers or joints in topic {}; its topics are {}", name_,
                                     in_quotes(crank_topic_), topics_.text([](const TopicChannel&) { return true; })));
    }
  }

  void finish() {
    if (is_finished_) return;
    is_finished_ = true;
    if (const std::string defect = recording_->defect(); !defect.empty()) warn("gzip stream", defect);
    check_choice();
    if (given_ > 0 || survey_) return;
    throw InputError({name_, 0}, fmt::format("has no message sensor_msgs/LaserScan; its topics are {}",
                                             topics_.text([](const TopicChannel&) { return true; })));
  }

  void warn(std::string_view kind, const std::string& detail) {
    if (!warnings_.add_to(kind)) warnings_.add(kind, fmt::format("{}: {}: {}", name_, recording_->place(), detail));
  }

  std::string format_;
  std::string name_;
  ReadOptions options_;
  std::unique_ptr<Recording> recording_;
  ScanAssembler assembler_;
  WarningCounter warnings_;
  std::vector<ScanSequence> sequences_;  ///< one for each laser
  TopicTable topics_;
  std::optional<RecordingSurvey> survey_;
  std::map<std::string, std::size_t, std::less<>> lasers_;  ///< numbers of lasers by their topics
  std::string odometry_topic_;
  std::string crank_topic_;
  std::string joint_;
  std::string unpacked_;  ///< the current message, if it was packed alone
  std::uint64_t crank_messages_ = 0;
  std::uint64_t given_ = 0;
  bool is_over_ = false;
  bool is_finished_ = false;
};

}  // namespace

std::unique_ptr<DescribedLog> open_bag(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                       const ReadOptions& options) {
  return std::make_unique<RecordingReader>([&] { return std::make_unique<Ros1Bag>(std::move(unpacked)); }, "ROS 1 bag",
                                           name, options);
}

std::unique_ptr<DescribedLog> open_mcap(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                        const ReadOptions& options) {
  return std::make_unique<RecordingReader>([&] { return std::make_unique<McapFile>(std::move(unpacked)); }, "MCAP",
                                           name, options);
}

std::unique_ptr<DescribedLog> open_ros2_bag(const std::string& path, const ReadOptions& options) {
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(path, ignored);
  return std::make_unique<RecordingReader>([&] { return is_folder ? open_ros2_folder(path) : open_ros2_file(path); },
                                           is_folder ? "ROS 2 bag" : "ROS 2 bag, one file", path, options);
}

}  // namespace gdtslam
