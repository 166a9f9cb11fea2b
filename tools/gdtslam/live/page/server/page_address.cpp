#include "page_address.hpp"

#include <arpa/inet.h>

#include <array>
#include <charconv>
#include <cstdint>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr int kMostPort = 65535;

bool is_numeric(const std::string& host) {
  std::array<std::uint8_t, sizeof(in6_addr)> bytes{};
  return ::inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

// "127.0.0.1:8080" without what follows the last colon that is none of an address.
std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::size_t bracket = host.rfind(']');
  const bool has_port = colon != std::string_view::npos && (bracket == std::string_view::npos || bracket < colon);
  return has_port ? host.substr(0, colon) : host;
}

}  // namespace

PageAddress page_address_of(const std::string& text) {
  PageAddress address;
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos) address.host = text.substr(0, colon);
  if (address.host.size() > 2 && address.host.starts_with('[') && address.host.ends_with(']')) {
    address.host = address.host.substr(1, address.host.size() - 2);
  }
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  const bool is_port = error == std::errc() && end == port.data() + port.size() && !port.empty() && address.port >= 0 &&
                       address.port <= kMostPort;
  if (!is_port || !is_numeric(address.host)) {
    throw UsageError("--page: '" + text + "' is no port from 0 to 65535, nor ADDRESS:PORT with an address in numbers");
  }
  return address;
}

bool may_ask(const PageAddress& address, std::string_view host, std::string_view origin) {
  if (host.empty()) return false;
  if (!origin.empty() && origin != "http://" + std::string(host)) return false;
  if (!address.is_loopback()) return true;
  const std::string_view name = without_port(host);
  return name == "localhost" || name == "[::1]" || name == address.host;
}

}  // namespace gdtslam
