// Addresses that `live` listens at, and checks of the requests it gets there. Thread-safe.
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

/// Parses PORT from 0 to 65535, or ADDRESS:PORT with a numeric address, in brackets if it has colons. Else empty.
std::optional<NetworkAddress> network_address(const std::string& text);

/// Whether a request is ours, by its host (with port) and the page's origin (empty: none). A page of another site must
/// not read this one, whatever name it gave to our address. So a host is localhost or this address; on an address that
/// others can reach, also any numeric address or this host's own name.
bool may_ask(const NetworkAddress& address, std::string_view host, std::string_view origin);

}  // namespace gdtslam
