#include "bag.hpp"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "bag_messages.hpp"
#include "bag_records.hpp"
#include "bag_scans.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/scan_sequence.hpp"
#include "engine/io/warning_counter.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostConnections = 65536;
constexpr std::size_t kMostTopicsTold = 12;

/// A topic, by one of its connections.
struct BagConnection {
  std::string topic;
  std::string type;
  BagMessage message = BagMessage::kOther;
  std::uint64_t count = 0;  ///< of messages so far
};

class BagReader final : public LogReader {
 public:
  BagReader(std::unique_ptr<ByteSource> source, std::string name, const ReadOptions& options)
      : name_(std::move(name)),
        options_(options),
        records_(opened(std::move(source))),
        scans_(options, [this](std::string_view kind, const std::string& detail) { warn(kind, detail); }) {
    if (!options_.topic.empty() && !options_.topic.starts_with('/')) options_.topic.insert(0, "/");
  }

  std::optional<LogRecord> next() override {
    while (true) {
      if (std::optional<ScanRecord> scan = scans_.next(is_over_)) {
        sequence_.check(scan->scan, [this](std::string_view kind, const char* detail) { warn(kind, detail); });
        ++given_;
        return std::move(*scan);
      }
      if (is_over_) break;
      const std::optional<BagRecord> record = next_record();
      record ? take(*record) : void(is_over_ = true);
    }
    finish();
    return std::nullopt;
  }
  [[nodiscard]] double progress() const override { return records_.source().progress(); }
  [[nodiscard]] const std::vector<Warning>& warnings() const override { return warnings_.list(); }

 private:
  BagRecords opened(std::unique_ptr<ByteSource> source) const {
    try {
      return BagRecords(std::move(source));
    } catch (const BagFault& fault) {
      throw InputError({name_, 0}, fault.what());
    }
  }

  [[nodiscard]] bool is_wanted(std::uint32_t connection) const {
    const auto found = connections_.find(connection);
    if (found == connections_.end() || found->second.message == BagMessage::kOther) return false;
    const BagConnection& known = found->second;
    if (known.message == BagMessage::kScan) return scan_topic_.empty() || known.topic == scan_topic_;
    return known.message != BagMessage::kOdometry || odometry_topic_.empty() || known.topic == odometry_topic_;
  }

  /// Nothing at the end, also of a bag that was cut.
  std::optional<BagRecord> next_record() {
    while (true) {
      try {
        return records_.next([this](std::uint32_t connection) { return is_wanted(connection); },
                             [this](std::string_view kind, const std::string& detail) { warn(kind, detail); });
      } catch (const BagFault& fault) {
        const bool is_cut = dynamic_cast<const BagCut*>(&fault) != nullptr;
        const std::string what = fault.what();
        const std::uint64_t at = records_.offset();
        const bool goes_on = records_.skip_damage();
        if (is_cut && !goes_on) {
          warn_at("cut bag", what + "; what came before counts", at);
          return std::nullopt;
        }
        refuse("damaged chunk", what, at);
        if (!goes_on) return std::nullopt;
      }
    }
  }

  void refuse(std::string_view kind, const std::string& what, std::uint64_t at) {
    if (!options_.lenient) {
      throw InputError({name_, 0}, fmt::format("{} before byte {}; --lenient leaves out what is damaged", what, at));
    }
    warn_at(kind, what, at);
  }

  void take(const BagRecord& record) {
    try {
      record.is_connection ? take_connection(record) : take_message(record);
    } catch (const BagFault& fault) {
      refuse("malformed message", fault.what(), records_.offset());
    }
  }

  void take_connection(const BagRecord& record) {
    if (connections_.size() >= kMostConnections || connections_.contains(record.connection)) return;
    const BagFields fields(record.data);
    BagConnection connection;
    connection.topic = record.topic.empty() ? std::string(fields.find("topic").value_or("")) : record.topic;
    connection.type = std::string(fields.find("type").value_or("*"));
    connection.message = bag_message_of(connection.type, fields.find("md5sum").value_or(""));
    if (connection.message == BagMessage::kScan && connection.topic == options_.topic) scan_topic_ = connection.topic;
    connections_.emplace(record.connection, std::move(connection));
  }

  void take_message(const BagRecord& record) {
    const auto found = connections_.find(record.connection);
    if (found == connections_.end()) throw BagFault("has a message of no known connection");
    BagConnection& connection = found->second;
    ++connection.count;
    if (connection.message == BagMessage::kScan) {
      take_scan(connection, record);
    } else if (connection.message == BagMessage::kOdometry) {
      if (odometry_topic_.empty()) odometry_topic_ = connection.topic;
      if (connection.topic == odometry_topic_) {
        scans_.add_odometry(bag_odometry(record.data));
      } else {
        warn("second odometry topic",
             fmt::format("{} is used, {} is not", odometry_topic_, in_quotes(connection.topic)));
      }
    } else if (connection.message == BagMessage::kTransforms) {
      for (const BagTransform& transform : bag_transforms(record.data)) scans_.add_transform(transform);
    }
  }

  void take_scan(const BagConnection& connection, const BagRecord& record) {
    if (!options_.topic.empty() && connection.topic != options_.topic) return;
    if (scan_topic_.empty()) scan_topic_ = connection.topic;
    if (connection.topic != scan_topic_) refuse_to_choose();
    BagScan scan = bag_scan(record.data);
    if (scan.stamp_s == 0.0) {
      scan.stamp_s = record.received_s;
      warn("scan without stamp", "it gets the time when the bag received it");
    }
    scans_.add(std::move(scan));
  }

  /// Counts the rest of the bag, so that the choice can be told with its numbers.
  [[noreturn]] void refuse_to_choose() {
    try {
      while (const std::optional<BagRecord> record =
                 records_.next([](std::uint32_t) { return false; }, [](std::string_view, const std::string&) {})) {
        if (record->is_connection) take_connection(*record);
        const auto found = connections_.find(record->connection);
        if (!record->is_connection && found != connections_.end()) ++found->second.count;
      }
    } catch (const BagFault&) {  // counted as far as it goes
    }
    throw UsageError(fmt::format("{}: has several topics with scans: {}; choose one with --topic", name_,
                                 topics([](const BagConnection& one) { return one.message == BagMessage::kScan; })));
  }

  /// "/scan (1,988 messages), /rear (12)": each topic once.
  template <class Test>
  [[nodiscard]] std::string topics(const Test& is_told) const {
    std::map<std::string, std::pair<std::string, std::uint64_t>> by_name;
    for (const auto& [number, connection] : connections_) {
      if (!is_told(connection)) continue;
      auto& [type, count] = by_name[connection.topic];
      type = connection.type;
      count += connection.count;
    }
    std::string text;
    std::size_t told = 0;
    for (const auto& [topic, what] : by_name) {
      if (told++ == kMostTopicsTold) return text + " and others";
      text += fmt::format("{}{} ({}, {})", text.empty() ? "" : ", ", one_line(topic, 80), one_line(what.first, 80),
                          what.second);
    }
    return text.empty() ? "none" : text;
  }

  void finish() {
    if (is_finished_) return;
    is_finished_ = true;
    if (const std::string defect = records_.source().defect(); !defect.empty()) warn("gzip stream", defect);
    if (given_ > 0) return;
    const auto is_scan = [](const BagConnection& one) { return one.message == BagMessage::kScan; };
    if (!options_.topic.empty() && scan_topic_.empty()) {
      throw UsageError(fmt::format("{}: has no scans in topic {}; those with scans are {}", name_,
                                   in_quotes(options_.topic), topics(is_scan)));
    }
    throw InputError({name_, 0}, fmt::format("has no message sensor_msgs/LaserScan; its topics are {}",
                                             topics([](const BagConnection&) { return true; })));
  }

  void warn(std::string_view kind, const std::string& detail) { warn_at(kind, detail, records_.offset()); }
  void warn_at(std::string_view kind, const std::string& detail, std::uint64_t at) {
    if (!warnings_.add_to(kind)) warnings_.add(kind, fmt::format("{}: before byte {}: {}", name_, at, detail));
  }

  std::string name_;
  ReadOptions options_;
  BagRecords records_;
  BagScans scans_;
  WarningCounter warnings_;
  ScanSequence sequence_;
  std::map<std::uint32_t, BagConnection> connections_;
  std::string scan_topic_;
  std::string odometry_topic_;
  std::uint64_t given_ = 0;
  bool is_over_ = false;
  bool is_finished_ = false;
};

}  // namespace

std::unique_ptr<LogReader> open_bag(std::unique_ptr<ByteSource> unpacked, const std::string& name,
                                    const ReadOptions& options) {
  return std::make_unique<BagReader>(std::move(unpacked), name, options);
}

std::unique_ptr<LogReader> open_bag(std::span<const std::byte> data, const std::string& name,
                                    const ReadOptions& options) {
  return open_bag(gunzip_if_packed(open_memory_source(data), name), name, options);
}

}  // namespace gdtslam
