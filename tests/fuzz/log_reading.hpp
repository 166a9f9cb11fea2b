// What holds for the records, the contents and the errors of every reader of logs.
#pragma once

#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "engine/io/byte_source.hpp"
#include "engine/io/log_contents.hpp"
#include "gdtslam/core/stream.hpp"
#include "gdtslam/io/log.hpp"
#include "target.hpp"

namespace gdtslam::fuzz {

inline void check_record(const LogRecord& record) {
  if (const auto* scan = std::get_if<ScanRecord>(&record)) {
    require(std::isfinite(scan->scan.stamp_s) && (!scan->T_odom_base || scan->T_odom_base->is_finite()));
    for (const float range_m : scan->scan.ranges_m) {
      require(range_m >= 0.0F);  // neither negative nor not a number
    }
  }
}

inline void check_contents(const LogContents& contents) {
  require(contents.topics.size() <= 256 && contents.frames.size() <= 4096 && contents.lines.size() <= 65);
  for (const TopicContents& topic : contents.topics) {
    require(topic.frames.size() <= 4 && topic.joints.size() <= 16 && topic.rate_hz() >= 0.0);
    require(!topic.delay ||
            (topic.delay->low_s <= topic.delay->median_s && topic.delay->median_s <= topic.delay->high_s));
  }
}

/// UsageError is for a choice between several topics.
template <class Open>
void drain(const Open& open, std::span<const std::byte> data, bool lenient, bool survey = false) {
  expect_typed<UsageError, InputError>([&] {
    const std::unique_ptr<DescribedLog> reader =
        open(gunzip_if_packed(open_memory_source(data), "fuzz"), "fuzz", {.lenient = lenient, .survey = survey});
    while (const std::optional<LogRecord> record = reader->next()) check_record(*record);
    require(reader->warnings().size() <= 65);
    check_contents(reader->contents());
  });
}

}  // namespace gdtslam::fuzz
