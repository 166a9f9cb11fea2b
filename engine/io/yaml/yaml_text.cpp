#include "yaml_text.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <string_view>

#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/message_text.hpp"
#include "engine/io/unpack_source.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kMostQuoted = 400;  // bytes of yaml-cpp's message, which may quote the file

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

/// Counts the values of a document without building it, and stops the parser beyond the limit.
class NodeCounter final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { count(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override { count(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                const std::string& /*value*/) override {
    count(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                       YAML::EmitterStyle::value /*style*/) override {
    count(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t /*anchor*/,
                  YAML::EmitterStyle::value /*style*/) override {
    count(mark);
  }
  void OnMapEnd() override {}

 private:
  void count(const YAML::Mark& mark) {
    if (++nodes_ > kMaxYamlNodes) {
      throw YAML::ParserException(mark, fmt::format("more than {} values in one file", kMaxYamlNodes));
    }
  }

  std::size_t nodes_ = 0;
};

// True if anything follows the first document. (YAML::LoadAll never returns from some faulty texts.)
bool goes_on_after_its_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  NodeCounter counter;
  parser.HandleNextDocument(counter);
  return static_cast<bool>(parser);
}

}  // namespace

template <class Failure>
std::string read_text(const std::string& path, std::size_t most_bytes) {
  const std::unique_ptr<ByteSource> source = open_file_source(path);
  try {
    return read_all(*source, most_bytes, path == "-" ? "standard input" : path);
  } catch (const InputError& error) {
    throw Failure(error.what());
  }
}

template <class Failure>
YAML::Node parse_yaml(const std::string& text, const std::string& name) {
  for (const std::string_view magic : {kGzipMagic, kBzip2Magic, kXzMagic, kZstdMagic}) {
    if (text.starts_with(magic)) throw Failure({name, 0}, "is a packed file and no YAML; unpack it first");
  }
  if (is_nested_too_deep(text)) {
    throw Failure({name, 0}, "is not valid YAML: nested too deeply for a file of this kind");
  }
  try {
    if (goes_on_after_its_document(text)) {
      throw Failure({name, 0}, "holds more than one YAML document; one is expected");
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    const std::uint64_t line = error.mark.is_null() ? 0 : static_cast<std::uint64_t>(error.mark.line) + 1;
    throw Failure({name, line}, "is not valid YAML: " + one_line(error.msg, kMostQuoted));
  }
}

template std::string read_text<InputError>(const std::string&, std::size_t);
template std::string read_text<ConfigError>(const std::string&, std::size_t);
template YAML::Node parse_yaml<InputError>(const std::string&, const std::string&);
template YAML::Node parse_yaml<ConfigError>(const std::string&, const std::string&);

}  // namespace gdtslam
