#include "gdtslam/io/yaml_text.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <cstddef>
#include <sstream>

namespace gdtslam {
namespace {

/// Lets a document pass.
class IgnoreEvents final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const YAML::Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {}
  void OnSequenceStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& /*mark*/, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {}
  void OnMapEnd() override {}
};

}  // namespace

bool goes_on_after_its_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  IgnoreEvents ignore;
  parser.HandleNextDocument(ignore);
  return static_cast<bool>(parser);
}

bool is_nested_too_deep(std::string_view text) {
  constexpr int kMaxDepth = 32;
  constexpr std::size_t kMaxIndent = 256;
  int depth = 0;
  std::size_t line_begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    depth += c == '[' || c == '{' ? 1 : 0;
    depth -= (c == ']' || c == '}') && depth > 0 ? 1 : 0;
    if (c == '\n') {
      line_begin = i + 1;
    }
    // "- - - -" and "? ? ?" nest without brackets, one level for two characters
    const bool is_nesting_mark = c == '-' || c == '?' || c == ':';
    if (depth > kMaxDepth ||
        (is_nesting_mark && i - line_begin > kMaxIndent && i + 1 < text.size() && text[i + 1] == ' ' &&
         text.substr(line_begin, i - line_begin).find_first_not_of(" -?:") == std::string_view::npos)) {
      return true;
    }
  }
  return false;
}

}  // namespace gdtslam
