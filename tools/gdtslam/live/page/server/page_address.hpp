// Where the page is served, and to whom. Thread-safe.
#pragma once

#include <string>
#include <string_view>

namespace gdtslam {

struct PageAddress {
  std::string host = "127.0.0.1";
  int port = 0;
  [[nodiscard]] bool is_loopback() const { return host.starts_with("127.") || host == "::1"; }
};

/// PORT or ADDRESS:PORT, in brackets where the address has colons. Throws UsageError.
PageAddress page_address_of(const std::string& text);

/// Whether a request for that host (with its port), from a page of that origin (empty: of none), is one of ours. A page
/// of another site that a browser shows must not read what this one does, whatever name it gave to our address: a host
/// is localhost or this address; where others may reach it, an address in numbers or this host's own name.
bool may_ask(const PageAddress& address, std::string_view host, std::string_view origin);

}  // namespace gdtslam
