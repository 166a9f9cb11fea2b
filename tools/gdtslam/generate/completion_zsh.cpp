#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "completion.hpp"

namespace gdtslam {
namespace {

/// The functions that offer values, one for each different offer.
class OfferFunctions {
 public:
  /// The name of the function; empty for no offer.
  std::string name_of(const Offers& offers) {
    if (offers.is_empty()) return {};
    const std::string body = body_of(offers);
    const auto [found, is_new] = names_.emplace(body, fmt::format("_gdtslam_values_{}", names_.size() + 1));
    if (is_new) text_ += fmt::format("{}() {{\n{}}}\n\n", found->second, body);
    return found->second;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string body_of(const Offers& offers) {
    if (offers.has_settings) return "  _gdtslam_setting\n";
    std::string body = "  _alternative";
    if (!offers.words.empty()) body += fmt::format(" \\\n    'names:name:({})'", spaced(offers.words));
    if (offers.has_files && offers.endings.empty()) body += " \\\n    'files:file:_files'";
    if (offers.has_files && !offers.endings.empty()) {
      body += fmt::format(" \\\n    'files:file:_files -g \"*({})\"'", fmt::join(offers.endings, "|"));
    }
    if (offers.has_folders && !offers.has_files) body += " \\\n    'folders:folder:_files -/'";
    return body + "\n";
  }

  std::map<std::string, std::string> names_;
  std::string text_;
};

// In the brackets of a specification of _arguments.
std::string in_zsh_brackets(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string zsh_function_name(const CommandText& command) {
  std::string name = "_" + command.path;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

// "'(-o --output)-o+[Folder]:DIR:_gdtslam_values_1' '(...)--output=[Folder]:DIR:_gdtslam_values_1'"
std::string zsh_option(const OptionText& option, OfferFunctions& functions) {
  std::string specs;
  const std::string names = spaced(option.names);
  for (const std::string& name : option.names) {
    std::string spec = option.repeats ? "*" : "(" + names + ")";
    spec += name;
    if (!option.value.empty()) spec += name.starts_with("--") ? "=" : "+";
    spec += "[" + in_zsh_brackets(option.doc) + "]";
    if (!option.value.empty()) spec += ":" + in_zsh_brackets(option.value) + ":" + functions.name_of(option.offers);
    specs += " \\\n    " + quoted_for_shell(spec);
  }
  return specs;
}

std::string zsh_argument(const OptionText& argument, OfferFunctions& functions) {
  const std::string function = functions.name_of(argument.offers);
  const std::string spec = (argument.repeats       ? "*:"
                            : argument.is_required ? ":"
                                                   : "::") +
                           in_zsh_brackets(argument.names.front()) + ":" + (function.empty() ? " " : function);
  return " \\\n    " + quoted_for_shell(spec);
}

std::string zsh_command(const CommandText& command, OfferFunctions& functions) {
  const bool has_commands = !command.commands.empty();
  std::string text = fmt::format("{}() {{\n", zsh_function_name(command));
  if (has_commands) text += "  local curcontext=\"$curcontext\" state\n";
  text += has_commands ? "  _arguments -C -S" : "  _arguments -S";
  for (const OptionText* option : options_in(command)) text += zsh_option(*option, functions);
  for (const OptionText& argument : command.arguments) text += zsh_argument(argument, functions);
  if (!has_commands) return text + "\n}\n\n";
  text += " \\\n    '1: :->command' '*:: :->rest'\n  case $state in\n    command)\n      local -a commands=(";
  std::string cases;
  for (const CommandText& below : command.commands) {
    if (below.group == kMissingCommands) continue;
    std::string entry = below.name + ":" + below.doc;
    text += "\n        " + quoted_for_shell(entry);
    cases += fmt::format("        {}) {} ;;\n", below.name, zsh_function_name(below));
  }
  text += "\n      )\n      _describe -t commands command commands\n      ;;\n    rest)\n      case $words[1] in\n";
  return text + cases + "      esac\n      ;;\n  esac\n}\n\n";
}

// Behind "path=" its values, else the paths, to which no blank is added.
std::string zsh_settings(const SettingRows& settings) {
  std::string paths;
  std::string text = "_gdtslam_setting() {\n  if compset -P '*='; then\n    case ${IPREFIX##*[[:blank:]]} in\n";
  for (const OptionRow& row : settings) {
    paths += "\n    " + quoted_for_shell(row.path + ":" + row.doc);
    if (!row.choices.empty()) text += fmt::format("      *{}=) compadd -- {} ;;\n", row.path, spaced(row.choices));
  }
  return text + "    esac\n    return\n  fi\n  local -a paths=(" + paths +
         "\n  )\n  _describe -t settings option paths -S = -q\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandText& root, const SettingRows& settings) {
  OfferFunctions functions;
  std::string commands;
  for (const CommandText* command : commands_from(root)) commands += zsh_command(*command, functions);
  return "#compdef gdtslam\n# zsh completion for gdtslam, made by 'gdtslam generate completion zsh'.\n\n" +
         zsh_settings(settings) + functions.text() + commands +
         "if [ \"$funcstack[1]\" = _gdtslam ]; then\n  _gdtslam \"$@\"\nelse\n  compdef _gdtslam gdtslam\nfi\n";
}

}  // namespace gdtslam
