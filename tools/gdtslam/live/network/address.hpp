// Addresses that `live` listens at, and who may ask there. Thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gdtslam {

struct NetworkAddress {
  std::string host = "127.0.0.1";
  int port = 0;
  [[nodiscard]] bool is_loopback() const { return host.starts_with("127.") || host == "::1"; }
  /// The host in brackets if it has colons, and the port.
  [[nodiscard]] std::string text() const;
};

/// PORT from 0 to 65535, or ADDRESS:PORT, the address in numbers, in brackets if it has colons; nothing for other text.
std::optional<NetworkAddress> network_address(const std::string& text);

/// Whether a request for that host (with its port), from a page of that origin (empty: of none), is one of ours. A page
/// of another site that a browser shows must not read what this one does, whatever name it gave to our address: a host
/// is localhost or this address; where others may reach it, an address in numbers or this host's own name.
bool may_ask(const NetworkAddress& address, std::string_view host, std::string_view origin);

}  // namespace gdtslam
