// Lines of a text log; topics, frames and clocks of a recording.
#include "tools/gdtslam/doctor/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/core/one_line.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/ticks.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostRows = 40;  // topics or frames on the terminal
constexpr std::size_t kMostName = 60;
constexpr double kOtherClock_s = 1.0;  // a larger difference means that stamps and receipt times use different clocks

/// Aligns the rows' cells in columns as wide as their widest cell; the last column is not padded.
std::string table_text(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const std::vector<std::string>& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text;
  for (std::size_t r = 0; r < rows.size() && r < kMostRows; ++r) {
    std::string line = " ";
    for (std::size_t k = 0; k < rows[r].size(); ++k) line += fmt::format(" {:<{}} ", rows[r][k], widths[k]);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  if (rows.size() > kMostRows) text += fmt::format("  and {} more; --json has all\n", rows.size() - kMostRows);
  return text;
}

std::string name_text(const std::string& name) { return one_line(name, kMostName); }

std::string rate_text(double rate_hz) { return rate_hz > 0.0 ? fmt::format("{:.1f} Hz", rate_hz) : "-"; }

std::string joined(const std::vector<std::string>& names, std::string_view between) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : std::string(between)) + name_text(name);
  return text;
}

const char* as_text(TopicUse use) {
  switch (use) {
    case TopicUse::kScans:
      return "scans";
    case TopicUse::kOdometry:
      return "odometry";
    case TopicUse::kFrames:
      return "frames";
    case TopicUse::kCrank:
      return "crank";
    case TopicUse::kNone:
      break;
  }
  return "not used";
}

std::string use_text(const TopicContents& topic) {
  std::string text = fmt::format("{}: {}", as_text(topic.use), topic.why);
  if (topic.numbers) text += fmt::format("; {:g} to {:g}", topic.numbers->least, topic.numbers->most);
  if (!topic.joints.empty()) text += "; joints " + joined(topic.joints, ", ");
  return text;
}

std::string topics_text(const LogContents& contents) {
  if (contents.topics.empty()) return "topics           none\n";
  std::vector<std::vector<std::string>> rows;
  rows.reserve(contents.topics.size());
  for (const TopicContents& topic : contents.topics) {
    rows.push_back({name_text(topic.name), name_text(topic.type), with_commas(topic.messages),
                    rate_text(topic.rate_hz()), topic.frames.empty() ? "-" : joined(topic.frames, ","),
                    use_text(topic)});
  }
  std::string text = "topics           name, type, messages, rate, frame, what map does with it\n" + table_text(rows);
  if (contents.topics_left_out > 0) text += fmt::format("  and {} others\n", contents.topics_left_out);
  return text;
}

std::string place_text(const FrameLink& link) {
  std::string text = fmt::format("{:.3f} m ahead, {:.3f} m left, {:.3f} m up, turned {:.2f} deg", link.x_m, link.y_m,
                                 link.z_m, deg_from_rad(link.yaw_rad));
  constexpr double kLevel_rad = 0.001;
  if (std::fabs(link.pitch_rad) < kLevel_rad && std::fabs(link.roll_rad) < kLevel_rad) return text;
  return text +
         fmt::format(", pitch {:.2f} deg, roll {:.2f} deg", deg_from_rad(link.pitch_rad), deg_from_rad(link.roll_rad));
}

std::string frames_text(const LogContents& contents) {
  if (contents.frames.empty()) return "frames           none: the recording has no transforms\n";
  std::vector<std::vector<std::string>> rows;
  rows.reserve(contents.frames.size());
  for (const FrameLink& link : contents.frames) {
    rows.push_back({name_text(link.parent) + " > " + name_text(link.child), link.is_static ? "static" : "changing",
                    with_commas(link.messages), rate_text(link.rate_hz()),
                    link.moves ? "moves" : "stands: " + place_text(link)});
  }
  return "frames           parent > child, kind, transforms, rate, where\n" + table_text(rows);
}

std::string delay_of_topic(const TopicDelay& delay) {
  const double size_s = std::fabs(delay.median_s);
  if (size_s > kOtherClock_s) {
    return fmt::format("another clock: {:.3f} s {} the recorder's, +-{:.3f} s", size_s,
                       delay.median_s > 0.0 ? "behind" : "ahead of", 0.5 * (delay.high_s - delay.low_s));
  }
  return fmt::format("received {:.3f} s after the stamp, mostly {:.3f} to {:.3f} s", delay.median_s, delay.low_s,
                     delay.high_s);
}

std::string clocks_text(const LogContents& contents) {
  std::vector<std::vector<std::string>> rows;
  for (const TopicContents& topic : contents.topics) {
    if (topic.messages == 0 || topic.can_be == TopicUse::kNone) continue;
    const bool is_told = topic.delay || topic.can_be != TopicUse::kFrames;
    if (!is_told) continue;
    rows.push_back({name_text(topic.name), topic.delay ? delay_of_topic(*topic.delay) : "no stamps: by its receipt"});
  }
  return rows.empty() ? "" : "clocks\n" + table_text(rows);
}

std::string mount_text(const LaserContents& laser, std::size_t number, const LogCheck& check) {
  if (laser.mount == MountSource::kStated) return "as stated by --mount";
  if (laser.mount == MountSource::kUnknown) {
    return fmt::format("unknown: no transform leads from {} to the robot; taken as the robot's own centre",
                       laser.frame.empty() ? "a frame without a name" : name_text(laser.frame));
  }
  std::string text = "by the transforms " + joined(laser.chain, " < ");
  const auto mount = std::find_if(check.lasers.begin(), check.lasers.end(),
                                  [number](const LaserMount& m) { return m.laser == number; });
  if (mount == check.lasers.end()) return text;
  const Pose2& place = mount->T_base_laser;
  return text + fmt::format(": {:.3f} m ahead, {:.3f} m left, {:.2f} deg", place.x_m, place.y_m,
                            deg_from_rad(place.theta_rad));
}

std::string shift_text(std::optional<double> shift_s) {
  if (!shift_s || *shift_s == 0.0) return "";
  return fmt::format("; its stamps are moved by {:.3f} s into the laser's clock", *shift_s);
}

std::string uses_text(const LogContents& contents, const LogCheck& check) {
  std::string text;
  for (std::size_t k = 0; k < contents.lasers.size(); ++k) {
    const std::string label = contents.lasers.size() == 1 ? "laser" : fmt::format("laser {}", k);
    text += fmt::format("{:<16} {}, mount {}\n", label, name_text(contents.lasers[k].topic),
                        mount_text(contents.lasers[k], k, check));
  }
  if (contents.odometry.empty()) {
    text += "odometry from    nothing: the scans are matched to the map alone\n";
  } else {
    text += fmt::format("odometry from    {}, {} > {}: {}{}\n", name_text(contents.odometry),
                        name_text(contents.odometry_frame), name_text(contents.base_frame), contents.odometry_why,
                        shift_text(contents.odometry_clock_shift));
  }
  for (const TopicContents& topic : contents.topics) {
    if (topic.use != TopicUse::kCrank) continue;
    text += fmt::format("crank            {}: {}{}\n", name_text(topic.name), topic.why,
                        shift_text(contents.crank_clock_shift));
  }
  return text;
}

std::string lines_text(const LogContents& contents) {
  std::string text;
  for (const LineKind& kind : contents.lines) {
    text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", with_commas(kind.count), kind.name,
                        kind.is_read ? "" : " (not read)");
  }
  return fmt::format("lines            {}\n", text.empty() ? "none" : text);
}

Json topic_json(const TopicContents& topic) {
  Json json{{"name", topic.name},
            {"type", topic.type},
            {"encoding", topic.encoding},
            {"messages", topic.messages},
            {"first_s", topic.first_s},
            {"last_s", topic.last_s},
            {"rate_hz", topic.rate_hz()},
            {"frames", topic.frames},
            {"use", topic.use == TopicUse::kNone ? "none" : as_text(topic.use)},
            {"why", topic.why},
            {"receipt_after_stamp", nullptr},
            {"numbers", nullptr},
            {"joints", topic.joints}};
  if (topic.delay) {
    json["receipt_after_stamp"] = {{"messages", topic.delay->messages},
                                   {"median_s", topic.delay->median_s},
                                   {"low_s", topic.delay->low_s},
                                   {"high_s", topic.delay->high_s}};
  }
  if (topic.numbers) json["numbers"] = {{"least", topic.numbers->least}, {"most", topic.numbers->most}};
  return json;
}

Json frame_json(const FrameLink& link) {
  return {{"parent", link.parent},
          {"child", link.child},
          {"static", link.is_static},
          {"moves", link.moves},
          {"transforms", link.messages},
          {"rate_hz", link.rate_hz()},
          {"x_m", link.x_m},
          {"y_m", link.y_m},
          {"z_m", link.z_m},
          {"roll_rad", link.roll_rad},
          {"pitch_rad", link.pitch_rad},
          {"yaw_rad", link.yaw_rad}};
}

const char* as_text(MountSource source) {
  return source == MountSource::kStated ? "stated" : source == MountSource::kFrames ? "frames" : "unknown";
}

}  // namespace

std::string contents_text(const LogContents& contents, const LogCheck& check) {
  if (!contents.is_recording) return lines_text(contents);
  return topics_text(contents) + frames_text(contents) + clocks_text(contents) + uses_text(contents, check);
}

void add_contents(const LogContents& contents, Json& report) {
  report["format"] = contents.format;
  if (!contents.is_recording) {
    Json lines = Json::array();
    for (const LineKind& kind : contents.lines) {
      lines.push_back({{"kind", kind.name}, {"count", kind.count}, {"read", kind.is_read}});
    }
    report["lines"] = lines;
    return;
  }
  Json topics = Json::array();
  for (const TopicContents& topic : contents.topics) topics.push_back(topic_json(topic));
  Json frames = Json::array();
  for (const FrameLink& link : contents.frames) frames.push_back(frame_json(link));
  Json lasers = Json::array();
  for (const LaserContents& laser : contents.lasers) {
    lasers.push_back(
        {{"topic", laser.topic}, {"frame", laser.frame}, {"mount", as_text(laser.mount)}, {"chain", laser.chain}});
  }
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  report["topics"] = topics;
  report["topics_left_out"] = contents.topics_left_out;
  report["frames"] = frames;
  report["lasers"] = lasers;
  report["odometry"] = {{"topic", contents.odometry},
                        {"why", contents.odometry_why},
                        {"frame", contents.odometry_frame},
                        {"child", contents.base_frame},
                        {"clock_shift_s", or_null(contents.odometry_clock_shift)}};
  report["crank_clock_shift_s"] = or_null(contents.crank_clock_shift);
}

}  // namespace gdtslam
