#include "page_bytes.hpp"

#include "engine/core/base64.hpp"

namespace gdtslam::page {

void append_bytes_element(const std::string& id, std::span<const std::uint8_t> bytes, std::string& out) {
  out.append("<script type=\"text/plain\" id=\"").append(id).append("\">");
  append_base64(std::as_bytes(bytes), out);
  out.append("</script>\n");
}

}  // namespace gdtslam::page
