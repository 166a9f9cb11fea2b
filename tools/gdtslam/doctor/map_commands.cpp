// Commands that map a log.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/core/one_line.hpp"
#include "engine/runs/folder/linkage_file.hpp"
#include "tools/gdtslam/doctor/doctor.hpp"

namespace gdtslam {
namespace {

bool is_control(char c) { return (c >= '\0' && c < ' ') || c == '\x7f'; }

/// Quotes a text for a shell as one word, always on one line.
std::string shell_word(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  if (std::any_of(text.begin(), text.end(), is_control)) {  // quoted for bash, zsh and ksh
    std::string word = "$'";
    for (const char c : text) {
      const bool is_escaped = is_control(c) || c == '\'' || c == '\\';
      word += is_escaped ? fmt::format("\\x{:02x}", static_cast<unsigned char>(c)) : std::string(1, c);
    }
    return word + "'";
  }
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

std::string log_word(const std::string& log) {
  return log.size() > 1 && log.starts_with('-') ? shell_word("./" + log) : shell_word(log);
}

/// Options of doctor that map needs too, except the choice of topics.
std::string told_settings(const DoctorOptions& options) {
  std::string text;
  const auto add = [&text](std::string_view option, const std::string& value) {
    text += fmt::format(" {} {}", option, shell_word(value));
  };
  if (!options.settings.file.empty()) add("-c", options.settings.file);
  for (const std::string& set : options.settings.sets) add("--set", set);
  for (const std::string& mount : options.recording.mounts) add("--mount", mount);
  if (!options.recording.odometry.empty()) add("--odom", options.recording.odometry);
  return text;
}

/// Options that correct the faults which map does not correct itself.
std::string mending_settings(const std::vector<LogFinding>& faults) {
  std::string text;
  for (const LogFinding& fault : faults) text += fault.is_mended || fault.options.empty() ? "" : " " + fault.options;
  return text;
}

/// Adds the first command with the sensor's limit, because a constant range may be a wall.
void add_no_return_choice(const DoctorOptions& options, const LogCheck& check, std::vector<MapCommand>& commands) {
  const auto& sets = options.settings.sets;
  const bool is_stated =
      std::any_of(sets.begin(), sets.end(), [](const std::string& set) { return set.starts_with("log.max_range="); });
  const std::optional<NoReturnValue> value = check.no_returns.ambiguous(check.scan);
  if (!value || is_stated) return;
  MapCommand command = commands.front();
  command.when += command.when.empty() ? "" : ", and ";
  command.when +=
      fmt::format("if {} m is what the laser gives where it sees nothing, in {:.1f} % of the beams", value->range_m,
                  100.0 * static_cast<double>(value->beams) / static_cast<double>(check.ranges.beams));
  command.line.insert(command.line.rfind(" -o out"), " " + no_return_option(*value));
  if (commands.front().when.empty()) commands.front().when = "as the log says";
  commands.push_back(std::move(command));
}

/// Topics with messages that map could use in this role.
std::vector<const TopicContents*> topics_for(TopicUse use, const LogContents& contents) {
  std::vector<const TopicContents*> found;
  for (const TopicContents& topic : contents.topics) {
    if (topic.can_be == use && topic.messages > 0) found.push_back(&topic);
  }
  return found;
}

/// Choices of scan topics: none needed, or each topic in turn, then all together.
std::vector<MapCommand> scan_choices(const DoctorOptions& options, const LogContents& contents) {
  const auto choice = [](std::string_view when, const std::string& topic) {
    return MapCommand{std::string(when), topic.empty() ? "" : " --topic " + shell_word(topic)};
  };
  const std::vector<std::string>& stated = options.recording.topics;
  if (!stated.empty()) {
    MapCommand all = choice("", "");
    for (const std::string& topic : stated) all.line += " --topic " + shell_word(topic);
    return {all};
  }
  const std::vector<const TopicContents*> scans = topics_for(TopicUse::kScans, contents);
  if (scans.size() < 2) return {choice("", "")};
  std::vector<MapCommand> choices;
  choices.reserve(scans.size() + 1);
  for (const TopicContents* topic : scans) {
    choices.push_back(choice("with the scans of " + one_line(topic->name), topic->name));
  }
  choices.push_back(choice("with all lasers, if each sits where the transforms (or --mount NAME=x,y,yaw) say", "all"));
  return choices;
}

bool has_whole_numbers(const TopicContents& topic) {
  return topic.type.starts_with("std_msgs/Int") || topic.type.starts_with("std_msgs/UInt");
}

/// Possible meanings of a topic's numbers: ticks of a crank, a servo's degrees, or the elevation of a joint.
std::vector<MapCommand> nodding_choices(const TopicContents& topic) {
  constexpr double kMostDegrees = 360.0;
  const std::string when = "if " + one_line(topic.name) + " tells how the laser nods";
  const std::string line = " --crank " + shell_word(topic.name);
  if (!topic.joints.empty()) return {{when, line + " --set log.crank=tilt"}};  // radians, by ROS convention
  std::vector<MapCommand> choices;
  const bool may_be_degrees = topic.numbers->most - topic.numbers->least <= kMostDegrees;
  if (has_whole_numbers(topic) || !may_be_degrees) choices.push_back({when + ", in ticks of its crank", line});
  if (may_be_degrees) {
    const double middle = std::round(0.5 * (topic.numbers->least + topic.numbers->most));
    choices.push_back(
        {fmt::format("{}, in degrees, and {:g} is level", when, middle),
         fmt::format("{} --set log.crank=tilt --set log.crank_step=1deg --set log.crank_zero={:g}", line, middle)});
  }
  return choices;
}

/// Choices for all topics with distinct numbers.
std::vector<MapCommand> all_nodding_choices(const LogContents& contents) {
  std::vector<MapCommand> choices;
  for (const TopicContents* topic : topics_for(TopicUse::kCrank, contents)) {
    if (!topic->numbers || topic->numbers->least == topic->numbers->most) continue;
    for (MapCommand& choice : nodding_choices(*topic)) choices.push_back(std::move(choice));
  }
  return choices;
}

}  // namespace

std::vector<MapCommand> map_commands(const DoctorOptions& options, const LogContents& contents, const LogCheck& check,
                                     const std::vector<LogFinding>& faults) {
  if (!check.obstacle().empty()) return {};
  const bool is_damaged = std::any_of(check.warnings.begin(), check.warnings.end(), [](const auto& warning) {
    return warning.kind == "malformed line" || warning.kind == "malformed message" ||
           warning.kind == "damaged recording";
  });
  const std::string start = "gdtslam map " + log_word(options.log);
  const std::string end =
      told_settings(options) + mending_settings(faults) + (is_damaged ? " --lenient" : "") + " -o out";
  const std::string& crank = options.recording.crank;
  const std::string told_crank = crank.empty() ? "" : " --crank " + shell_word(crank);
  std::vector<MapCommand> commands = scan_choices(options, contents);
  const std::string first_choice = commands.front().line;
  for (MapCommand& command : commands) command.line = fmt::format("{}{}{}{}", start, command.line, told_crank, end);
  add_no_return_choice(options, check, commands);
  if (!crank.empty()) return commands;
  std::vector<MapCommand> nodding = all_nodding_choices(contents);
  for (MapCommand& command : nodding) command.line = fmt::format("{}{}{}{}", start, first_choice, command.line, end);
  // A linkage file beside the log means that the laser nods.
  const bool has_linkage = !linkage_sidecar(options.log).empty();
  commands.insert(has_linkage ? commands.begin() : commands.end(), nodding.begin(), nodding.end());
  return commands;
}

}  // namespace gdtslam
