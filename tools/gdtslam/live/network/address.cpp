#include "address.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdint>

namespace gdtslam {
namespace {

constexpr int kMostPort = 65535;

bool is_numeric(const std::string& host) {
  std::array<std::uint8_t, sizeof(in6_addr)> bytes{};
  return ::inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

// "127.0.0.1:8080" without its port.
std::string_view without_port(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::size_t bracket = host.rfind(']');
  const bool has_port = colon != std::string_view::npos && (bracket == std::string_view::npos || bracket < colon);
  return has_port ? host.substr(0, colon) : host;
}

std::string without_brackets(std::string_view host) {
  if (host.size() > 2 && host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return std::string(host);
}

// Accepts this host's own name and its name in multicast DNS. Anyone may register a name in another domain.
bool is_name_of_this_host(std::string_view name) {
  std::array<char, 256> text{};
  if (::gethostname(text.data(), text.size() - 1) != 0) return false;
  const std::string own = text.data();
  return !own.empty() && (name == own || name == own + ".local");
}

}  // namespace

std::string NetworkAddress::text() const {
  const bool has_colons = host.find(':') != std::string::npos;
  return (has_colons ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::optional<NetworkAddress> network_address(const std::string& text) {
  NetworkAddress address;
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos) address.host = without_brackets(text.substr(0, colon));
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  const char* const end = port.data() + port.size();
  const auto [last, error] = std::from_chars(port.data(), end, address.port);
  const bool is_port = error == std::errc() && last == end && address.port >= 0 && address.port <= kMostPort;
  return is_port && is_numeric(address.host) ? std::optional(address) : std::nullopt;
}

bool may_ask(const NetworkAddress& address, std::string_view host, std::string_view origin) {
  if (host.empty()) return false;
  if (!origin.empty() && origin != "http://" + std::string(host)) return false;
  const std::string_view name = without_port(host);
  if (name == "localhost" || name == "[::1]" || name == address.host) return true;
  if (address.is_loopback()) return false;
  return is_numeric(without_brackets(name)) || is_name_of_this_host(name);
}

}  // namespace gdtslam
