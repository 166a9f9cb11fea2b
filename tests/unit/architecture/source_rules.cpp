#include "source_rules.hpp"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <regex>

namespace gdtslam::architecture {
namespace {

using SourceParts = std::set<std::string, std::less<>>;

constexpr std::size_t kMaxLines = 400;

/// Which parts of the project a part may include, itself apart; the table of docs/architecture.md.
const std::map<std::string, SourceParts, std::less<>>& allowed_parts() {
  static const SourceParts all{"core",  "compute", "vulkan",   "mapping", "io",   "sim", "calib",
                               "cloud", "drawing", "optimize", "viewer",  "runs", "c",   "tools"};
  static const std::map<std::string, SourceParts, std::less<>> table{
      {"core", {}},
      {"compute", {"core"}},
      {"vulkan", {"core", "compute", "shaders"}},
      {"mapping", {"core", "compute", "optimize"}},
      {"io", {"core"}},
      {"sim", {"core", "calib"}},
      {"calib", {"core", "cloud"}},
      {"cloud", {"core", "compute"}},
      {"drawing", {"core", "calib"}},
      {"runs", {"core", "compute", "mapping", "io", "cloud", "calib", "drawing"}},
      {"c", {"core", "compute", "mapping", "io", "drawing", "runs"}},
      {"optimize", {"core"}},
      {"viewer", {"core", "mapping", "calib", "cloud", "drawing"}},
      {"tools", all},
      {"examples", all},
      {"tests", all},
  };
  return table;
}

/// Third-party headers by their beginning, and the parts that may include them (tools and tests may include any).
struct Library {
  std::string_view header;
  SourceParts parts;
  bool is_linked_publicly = false;  ///< public headers may need it, because the part's users get it too
};

const std::vector<Library>& libraries() {
  static const SourceParts everybody{"core", "cloud", "drawing", "compute", "vulkan", "mapping", "optimize",
                                     "io",   "sim",   "calib",   "viewer",  "runs",   "c",       "examples"};
  static const std::vector<Library> table{
      {"Eigen/", everybody, true},
      {"yaml-cpp/", {"io", "runs"}},
      {"nlohmann/", {"io", "runs", "drawing"}},
      {"fmt/", {"io", "runs", "drawing", "viewer"}},
      {"png.h", {"io"}},
      {"zlib.h", {"io"}},
      {"bzlib.h", {"io"}},
      {"lz4frame.h", {"io"}},
      {"zstd.h", {"io"}},
      {"lzma.h", {"io"}},
      {"sqlite3.h", {"io"}},
      {"openssl/", {"io"}},
      {"embree3/", {"sim"}},
      {"ceres/", {"calib"}},
      {"nanoflann.hpp", {"cloud"}},
      {"vulkan/", {"vulkan"}},
      {"glm/", {"vulkan"}},
      {"vtk", {"viewer"}},
      {"GL/", {"viewer"}},
      {"EGL/", {"viewer"}},
      {"cairo", {"drawing"}},
      {"CLI/", {}},
      {"libwebsockets.h", {}},
      {"spdlog/", {}},
      {"gtest/", {}},
      {"gmock/", {}},
      {"rapidcheck", {}},
      {"mpfr.h", {}},
      {"gsl/", {}},
      {"nlopt.hpp", {}},
      {"pagmo/", {}},
      {"benchmark/", {}},
  };
  return table;
}

bool is_one_of(std::string_view value, std::initializer_list<std::string_view> list) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines.push_back(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  }
  return lines;
}

/// One violation for each line of the text that the pattern matches.
std::vector<Violation> matching_lines(std::string_view text, const std::regex& pattern, std::string_view message) {
  std::vector<Violation> found;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    std::match_results<std::string_view::const_iterator> match;
    if (std::regex_search(line.begin(), line.end(), match, pattern)) {
      found.push_back({number, match.str() + ": " + std::string(message)});
    }
  }
  return found;
}

/// Behind the comment or literal that begins at `begin`; `begin` itself where neither does.
std::size_t end_of_token(std::string_view text, std::size_t begin) {
  const auto behind = [&](std::string_view mark, std::size_t from) {
    const std::size_t at = text.find(mark, from);
    return at == std::string_view::npos ? text.size() : at + mark.size();
  };
  const std::string_view rest = text.substr(begin);
  if (rest.starts_with("//")) return std::min(text.find('\n', begin), text.size());
  if (rest.starts_with("/*")) return behind("*/", begin + 2);
  if (rest.starts_with("R\"") && rest.find('(') != std::string_view::npos) {
    const std::size_t open = rest.find('(');
    return behind(")" + std::string(rest.substr(2, open - 2)) + "\"", begin + open);
  }
  // In 1'000'000 the mark separates digits.
  const bool in_word = begin > 0 && std::isalnum(static_cast<unsigned char>(text[begin - 1])) != 0;
  if (!rest.starts_with('"') && (!rest.starts_with('\'') || in_word)) return begin;
  std::size_t k = begin + 1;
  while (k < text.size() && text[k] != rest.front()) k += text[k] == '\\' ? 2U : 1U;
  return std::min(k + 1, text.size());
}

/// What is wrong with part including the header; empty when nothing is.
std::string include_fault(const std::string& part, bool is_public, const std::string& header, bool in_quotes) {
  if (header.find("..") != std::string::npos) return "leaves its folder";
  if (header.starts_with("gdtslam/")) {
    const std::string other = header.substr(8, header.find('/', 8) - 8);
    if (other == part || allowed_parts().at(part).contains(other)) return "";
    return part + " must not know " + other;
  }
  for (const Library& library : libraries()) {
    if (!header.starts_with(library.header)) continue;
    if (!is_one_of(part, {"tools", "tests"}) && !library.parts.contains(part)) {
      return part + " must not use this library";
    }
    if (is_public && !library.is_linked_publicly) return "a public header must not need this library";
    return "";
  }
  if (in_quotes && is_public) return "a public header includes public headers only";
  if (in_quotes) {
    const std::string other = part_of(header);
    const bool is_known = other.empty() || other == part || allowed_parts().at(part).contains(other);
    return is_known ? "" : part + " must not know " + other;
  }
  const bool is_of_the_system = header.find('/') == std::string::npos || header.starts_with("sys/") ||
                                header.starts_with("netinet/") || header.starts_with("arpa/");
  return is_of_the_system ? "" : "unknown library: name it in source_rules.cpp and docs/dependencies.md";
}

}  // namespace

std::string part_of(std::string_view path) {
  const std::size_t end = path.find('/');
  if (end == std::string_view::npos) return "";
  const std::string_view first = path.substr(0, end);
  if (first == "engine") {
    const std::string_view rest = path.substr(end + 1);
    const std::size_t rest_end = rest.find('/');
    return rest_end == std::string_view::npos ? "" : std::string(rest.substr(0, rest_end));
  }
  return is_one_of(first, {"calib", "viewer", "shaders", "tools", "examples", "tests"}) ? std::string(first) : "";
}

std::string without_comments_and_literals(std::string_view text) {
  std::string out(text);
  for (std::size_t k = 0; k < text.size();) {
    const std::size_t end = end_of_token(text, k);
    std::replace_if(
        out.begin() + static_cast<std::ptrdiff_t>(k), out.begin() + static_cast<std::ptrdiff_t>(end),
        [](char c) { return c != '\n'; }, ' ');
    k = std::max(end, k + 1);
  }
  return out;
}

std::vector<Violation> include_violations(std::string_view path, std::string_view text) {
  static const std::regex directive(R"re(^\s*#\s*include\s*([<"])([^>"]+)[>"])re");
  const std::string part = part_of(path);
  std::vector<Violation> found;
  if (part.empty() || !allowed_parts().contains(part)) return found;
  const bool is_public = path.find("/include/gdtslam/") != std::string_view::npos;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    std::match_results<std::string_view::const_iterator> match;
    if (!std::regex_search(line.begin(), line.end(), match, directive)) continue;
    const std::string header = match.str(2);
    const std::string fault = include_fault(part, is_public, header, match.str(1) == "\"");
    if (!fault.empty()) found.push_back({number, "includes " + header + ": " + fault});
  }
  return found;
}

std::vector<Violation> printing_violations(std::string_view path, std::string_view text) {
  static const std::regex printing(
      R"(\b(std\s*::\s*(cout|cerr|clog)|(v?f?printf|puts|putchar|fputs|perror)\s*\(|fmt\s*::\s*print))");
  if (is_one_of(part_of(path), {"", "tools", "examples", "tests", "shaders"})) return {};
  return matching_lines(without_comments_and_literals(text), printing, "a library does not print");
}

std::vector<Violation> determinism_violations(std::string_view path, std::string_view text) {
  static const std::regex libm(
      R"(\bstd\s*::\s*(a?sinh?|a?cosh?|a?tanh?|atan2|exp2?|expm1|log|log2|log10|log1p|pow|hypot|cbrt|erfc?|[lt]gamma)f?\s*\()");
  static const std::regex random(
      R"(\bstd\s*::\s*(rand\b|random_device|mt19937|default_random_engine|\w+_distribution))");
  static const std::regex fused(R"(\bstd\s*::\s*fmaf?\s*\()");
  if (!is_one_of(part_of(path), {"core", "compute", "mapping", "sim", "calib"})) return {};
  const std::string code = without_comments_and_literals(text);
  std::vector<Violation> found = matching_lines(code, libm, "differs between hosts; use gdtslam/core/elementary.hpp");
  for (auto& other : {matching_lines(code, random, "differs between libraries; use gdtslam/core/random.hpp"),
                      matching_lines(code, fused, "rounds once where the reference rounds twice")}) {
    found.insert(found.end(), other.begin(), other.end());
  }
  return found;
}

std::vector<Violation> form_violations(std::string_view path, std::string_view text) {
  // The words are broken in two, or this file would break its own rule.
  static const std::regex unfinished(
      "\\b(TO"
      "DO|FIX"
      "ME|XX"
      "X|HA"
      "CK|place"
      "holder|st"
      "ub|dum"
      "my|for n"
      "ow|not imple"
      "mented)\\b",
      std::regex::ECMAScript | std::regex::icase);
  std::vector<Violation> found;
  std::size_t number = 0;
  const std::vector<std::string_view> lines = lines_of(text);
  for (const std::string_view line : lines) {
    ++number;
    if (line.find('\t') != std::string_view::npos) found.push_back({number, "has a tab"});
    if (line.ends_with(' ')) found.push_back({number, "ends in a space"});
    if (line.ends_with('\r')) found.push_back({number, "ends in a carriage return"});
  }
  if (!text.empty() && text.back() != '\n') found.push_back({number, "the last line has no line break"});
  const bool is_code = is_one_of(path.substr(std::min(path.size(), path.rfind('.'))),
                                 {".cpp", ".hpp", ".inl", ".comp", ".glsl", ".sh", ".py"});
  if (is_code && lines.size() > kMaxLines) {
    found.push_back({0, std::to_string(lines.size()) + " lines: look for the seam and make it two files"});
  }
  const std::vector<Violation> marks = matching_lines(text, unfinished, "marks unfinished work");
  found.insert(found.end(), marks.begin(), marks.end());
  return found;
}

std::vector<Violation> header_violations(std::string_view path, std::string_view text) {
  if (!path.ends_with(".hpp")) return {};
  std::vector<Violation> found;
  if (path.find("/include/gdtslam/") != std::string_view::npos && !text.starts_with("// ")) {
    found.push_back({1, "a public header opens with a comment that says what it is"});
  }
  if (text.find("#pragma once") == std::string_view::npos) found.push_back({1, "has no #pragma once"});
  return found;
}

std::set<std::string> bibliography_keys(std::string_view bibtex) {
  static const std::regex entry(R"(^\s*@\w+\s*\{\s*([^,\s]+)\s*,)");
  std::set<std::string> keys;
  for (const std::string_view line : lines_of(bibtex)) {
    std::match_results<std::string_view::const_iterator> match;
    if (std::regex_search(line.begin(), line.end(), match, entry)) keys.insert(match.str(1));
  }
  return keys;
}

std::vector<Violation> citation_violations(std::string_view text, const std::set<std::string>& keys) {
  static const std::regex citation(R"(\[([A-Z][A-Za-z]+(19|20)[0-9]{2}[a-z]?)\b)");
  std::vector<Violation> found;
  std::size_t number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    const std::string copy(line);
    for (std::sregex_iterator at(copy.begin(), copy.end(), citation), end; at != end; ++at) {
      const std::string key = at->str(1);
      if (!keys.contains(key)) found.push_back({number, "cites " + key + ", which docs/references.bib lacks"});
    }
  }
  return found;
}

std::vector<std::string> relative_links(std::string_view markdown) {
  static const std::regex link(R"(\]\(([^)\s]+)\))");
  const std::string copy(markdown);
  std::vector<std::string> targets;
  for (std::sregex_iterator at(copy.begin(), copy.end(), link), end; at != end; ++at) {
    const std::string target = at->str(1);
    if (target.starts_with('#') || target.find("://") != std::string::npos || target.starts_with("mailto:")) continue;
    targets.push_back(target.substr(0, target.find('#')));
  }
  return targets;
}

std::vector<NameInFile> names_behind_links(std::string_view markdown) {
  static const std::regex link_with_names(R"(\]\(([^)\s#]+)\) (`\w+`(, `\w+`)*))");
  static const std::regex name("\\w+");
  const std::string copy(markdown);
  std::vector<NameInFile> found;
  for (std::sregex_iterator at(copy.begin(), copy.end(), link_with_names), end; at != end; ++at) {
    const std::string names = at->str(2);
    for (std::sregex_iterator word(names.begin(), names.end(), name); word != end; ++word) {
      found.push_back({at->str(1), word->str()});
    }
  }
  return found;
}

}  // namespace gdtslam::architecture
