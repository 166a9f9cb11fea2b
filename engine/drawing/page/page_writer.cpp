#include "page_writer.hpp"

#include <fmt/format.h>

#include "engine/core/base64.hpp"
#include "engine/drawing/letters.hpp"

/// The files of page/program as they were when the library was built.
namespace gdtslam::page_text_parts {
std::string_view skeleton();  ///< page.html with {{name}} where page_text fills in
std::string_view style();
std::string_view style_hash();  ///< for the content security policy, as that of the program
std::string_view program();     ///< all scripts, one after the other
std::string_view program_hash();
}  // namespace gdtslam::page_text_parts

namespace gdtslam::page {
namespace {

namespace parts = gdtslam::page_text_parts;

std::string policy(std::string_view sources) {
  return fmt::format("default-src 'none'; script-src {}; style-src {}; base-uri 'none'; form-action 'none'; {}",
                     parts::program_hash(), parts::style_hash(), sources);
}

}  // namespace

void add_element(PageData& data, std::string id, std::span<const std::uint8_t> bytes) {
  std::string text;
  append_base64(std::as_bytes(bytes), text);
  data.elements.emplace_back(std::move(id), std::move(text));
}

std::string json_text(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<' || c == '>' || c == '&') {
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      text += c;
    }
  }
  return text;
}

// In one pass, so that no text of others is taken for a mark.
std::string page_text(const PageData& data, std::string_view sources) {
  std::string_view skeleton = parts::skeleton();
  std::string out;
  while (true) {
    const std::size_t open = skeleton.find("{{");
    out += skeleton.substr(0, open);
    if (open == std::string_view::npos) return out;
    const std::size_t close = skeleton.find("}}", open);
    const std::string_view name = skeleton.substr(open + 2, close - open - 2);
    if (name == "title") out += markup_text(data.description.at("title").get_ref<const std::string&>());
    if (name == "policy") out += policy(sources);
    if (name == "style") out += parts::style();
    if (name == "data") out += json_text(data.description);
    if (name == "elements") {
      for (const auto& [id, text] : data.elements) {
        out.append("<script type=\"text/plain\" id=\"").append(id).append("\">").append(text).append("</script>\n");
      }
    }
    if (name == "program") out += parts::program();
    skeleton.remove_prefix(close + 2);
  }
}

}  // namespace gdtslam::page
