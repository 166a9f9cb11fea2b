#include <fmt/format.h>

#include "completion.hpp"

namespace gdtslam {
namespace {

constexpr const char* kFishHead = R"fish(# fish completion for gdtslam, made by 'gdtslam generate completion fish'.

# Whether the words typed so far lead to that command.
function __gdtslam_at
    set -l path gdtslam
    for word in (commandline -opc)[2..]
        if contains -- "$path $word" $__gdtslam_commands
            set path "$path $word"
        end
    end
    test "$path" = "$argv[1]"
end

# Folders, and files with one of these endings.
function __gdtslam_files
    set -l token (string replace -r -- '^--?[a-z-]+=' '' (commandline -ct))
    for file in (complete -C "__gdtslam_any $token")
        if string match -qr -- '/$' $file
            echo $file
            continue
        end
        for ending in $argv
            if string match -q -- "*$ending" $file
                echo $file
                break
            end
        end
    end
end

)fish";

// In single quotes of fish, where a backslash counts.
std::string quoted_for_fish(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

// The switches that say what is offered.
std::string fish_offer(const Offers& offers, bool is_value) {
  const bool is_any_file = offers.has_files && offers.endings.empty();
  std::string arguments = spaced(offers.words);
  const auto add = [&arguments](const std::string& part) { arguments += (arguments.empty() ? "" : " ") + part; };
  if (offers.has_settings) add("(__gdtslam_settings)");
  if (offers.has_files && !offers.endings.empty()) add(fmt::format("(__gdtslam_files {})", spaced(offers.endings)));
  if (offers.has_folders && !offers.has_files) add("(__fish_complete_directories)");
  std::string switches;
  if (is_value) switches = is_any_file ? " -r -F" : " -x";
  if (!is_value && is_any_file) switches = " -F";
  return arguments.empty() ? switches : switches + " -a " + quoted_for_fish(arguments);
}

std::string fish_lines(const CommandText& command) {
  const std::string at =
      fmt::format("complete -c gdtslam -n {}", quoted_for_fish("__gdtslam_at \"" + command.path + "\""));
  std::string text;
  for (const CommandText& below : command.commands) {
    if (below.group == kMissingCommands) continue;
    text += fmt::format("{} -a {} -d {}\n", at, below.name, quoted_for_fish(below.doc));
  }
  for (const OptionText* option : options_in(command)) {
    text += at;
    for (const std::string& name : option->names) {
      text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    }
    if (!option->value.empty()) text += fish_offer(option->offers, true);
    text += " -d " + quoted_for_fish(option->doc) + "\n";
  }
  const Offers arguments = offers_of_arguments(command);
  if (!arguments.is_empty()) text += at + fish_offer(arguments, false) + "\n";
  return text;
}

// Paths, and behind "path=" the values; fish adds no blank behind '='.
std::string fish_settings(const SettingRows& settings) {
  std::string text = "function __gdtslam_settings\n    switch (commandline -ct)\n";
  std::string paths;
  for (const OptionRow& row : settings) {
    paths += fmt::format("            echo -e {}\n", quoted_for_fish(row.path + "=\t" + row.doc));
    if (row.choices.empty()) continue;
    text += fmt::format("        case '*{}=*'\n            string join \\n", row.path);
    for (const std::string& choice : row.choices) text += fmt::format(" {}={}", row.path, choice);
    text += "\n";
  }
  return text + "        case '*'\n" + paths + "    end\nend\n\n";
}

}  // namespace

std::string fish_completion(const CommandText& root, const SettingRows& settings) {
  const std::vector<const CommandText*> commands = commands_from(root);
  std::string text = kFishHead + fish_settings(settings) + "set -g __gdtslam_commands";
  for (const CommandText* command : commands) text += " \\\n    " + quoted_for_fish(command->path);
  text += "\n\ncomplete -c gdtslam -f\n";
  for (const CommandText* command : commands) text += fish_lines(*command);
  return text;
}

}  // namespace gdtslam
