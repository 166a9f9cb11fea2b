#include "type_definitions.hpp"

#include <algorithm>
#include <optional>
#include <regex>

#include "source_rules.hpp"

namespace gdtslam::architecture {
namespace {

/// What a brace opens; a scope of no name is of no interest.
using Scope = std::optional<std::string>;

/// The text with every directive of the preprocessor, continued lines included, as blanks.
std::string without_directives(std::string text) {
  bool is_directive = false;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::size_t first = text.find_first_not_of(" \t", begin);
    is_directive = is_directive || (first < end && text[first] == '#');
    const bool goes_on = end > begin && text[end - 1] == '\\';
    if (is_directive) text.replace(begin, end - begin, end - begin, ' ');
    is_directive = is_directive && goes_on;
    begin = end + 1;
  }
  return text;
}

std::string without_spaces(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
  return text;
}

/// Short, because regular expressions take stack for every letter.
std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \n");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \n") + 1 - first));
}

/// The namespace that the statement before a brace opens; "" for extern "C", which opens none.
Scope namespace_of(const std::string& statement) {
  static const std::regex head(R"(^(?:inline\s+)?namespace\s+([\w:]+)$)");
  static const std::regex linkage(R"(^extern$)");
  std::smatch match;
  if (std::regex_match(statement, match, head)) return match.str(1);
  if (std::regex_match(statement, linkage)) return "";
  return std::nullopt;
}

/// The type that the statement before a brace begins to define.
std::optional<std::string> type_of(const std::string& statement) {
  static const std::regex head(
      R"(^(?:template\s*<[^{}]*>\s*)?(?:enum\s+(?:class\s+|struct\s+)?|class\s+|struct\s+|union\s+))"
      R"((?:alignas\s*\([^)]*\)\s*|\[\[[^\]]*\]\]\s*)*(\w+(?:\s*<[^()]*>)?)(?:\s+final)?\s*(?::[^:][\s\S]*)?$)");
  std::smatch match;
  if (!std::regex_match(statement, match, head)) return std::nullopt;
  return without_spaces(match.str(1));
}

}  // namespace

std::vector<TypeDefinition> type_definitions(std::string_view text) {
  const std::string code = without_directives(without_comments_and_literals(text));
  std::vector<TypeDefinition> found;
  std::vector<Scope> scopes;
  std::size_t statement_begin = 0;
  for (std::size_t k = code.find_first_of("{};"); k != std::string::npos; k = code.find_first_of("{};", k + 1)) {
    const std::string statement = trimmed(std::string_view(code).substr(statement_begin, k - statement_begin));
    statement_begin = k + 1;
    if (code[k] == '}' && !scopes.empty()) scopes.pop_back();
    if (code[k] != '{') continue;
    const bool is_named =
        std::all_of(scopes.begin(), scopes.end(), [](const Scope& scope) { return scope.has_value(); });
    Scope opened = is_named ? namespace_of(statement) : std::nullopt;
    if (const std::optional<std::string> type = is_named && !opened ? type_of(statement) : std::nullopt) {
      std::string name;
      for (const Scope& scope : scopes) name += scope->empty() ? "" : *scope + "::";
      const auto line = std::count(code.begin(), code.begin() + static_cast<std::ptrdiff_t>(k), '\n') + 1;
      found.push_back({name + *type, static_cast<std::size_t>(line)});
    }
    scopes.push_back(std::move(opened));
  }
  return found;
}

}  // namespace gdtslam::architecture
