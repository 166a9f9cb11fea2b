// The page's server by libwebsockets: one thread answers HTTP requests.
#include <fmt/format.h>
#include <libwebsockets.h>

#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "gdtslam/core/error.hpp"
#include "page_messages.hpp"
#include "tools/gdtslam/live/network/address.hpp"
#include "tools/gdtslam/live/page/live_page.hpp"

namespace gdtslam {
namespace {

using PageClock = std::chrono::steady_clock;

constexpr std::chrono::seconds kWatched{3};  // after the last request for a scan
// The drive needs descriptors too, and a process usually has 1,024: further visitors wait or are refused.
constexpr unsigned kMostConnections = 128;

std::string random_name() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

/// Returns the whole header of any length: a header that is too long must not pass for a missing one.
std::string header_text(lws* connection, lws_token_indexes name) {
  const int size = lws_hdr_total_length(connection, name);
  if (size <= 0) return {};
  std::string text(static_cast<std::size_t>(size) + 1, '\0');
  const int copied = lws_hdr_copy(connection, text.data(), static_cast<int>(text.size()), name);
  if (copied < 0) return "?";  // no host and no origin has this name
  text.resize(static_cast<std::size_t>(copied));
  return text;
}

NetworkAddress page_address(const std::string& text) {
  const std::optional<NetworkAddress> address = network_address(text);
  if (address) return *address;
  throw UsageError("--page: '" + text +
                   "' is neither a port from 0 to 65535 nor ADDRESS:PORT with an address in numbers");
}

struct Answer {
  std::string body;
  const char* type = "application/json";
  bool is_compressed = false;
};

class PageServer final : public LivePage {
 public:
  PageServer(const std::string& address, const std::string& title);
  ~PageServer() override;

  [[nodiscard]] std::string url() const override { return "http://" + address_.text() + "/"; }
  [[nodiscard]] bool is_watched() const override { return PageClock::now() - asked_.load() < kWatched; }
  void show(ShownScan scan) override;
  void show(const OccupancyMap& map, const Trajectory& path) override;

 private:
  static int on_event(lws* connection, lws_callback_reasons reason, void* session, void* data, std::size_t size);
  int begin_answer(lws* connection, std::string_view path);
  int finish_answer(lws* connection);
  [[nodiscard]] std::optional<Answer> answer_for(std::string_view path);

  NetworkAddress address_;
  std::string title_;
  std::array<lws_protocols, 2> protocols_{};
  lws_context* context_ = nullptr;
  std::map<lws*, std::string> bodies_;  // waiting to be written; used by the thread
  std::atomic<PageClock::time_point> asked_{PageClock::time_point{}};
  std::atomic<bool> is_ending_ = false;
  // Shared by all threads, under the lock:
  std::mutex mutex_;
  PageDrive drive_{.name = random_name()};
  std::optional<ShownScan> scan_;
  std::string map_;
  std::thread thread_;
};

PageServer::PageServer(const std::string& address, const std::string& title)
    : address_(page_address(address)), title_(title) {
  lws_set_log_level(0, nullptr);
  protocols_[0] = {"http", &PageServer::on_event, 0, 0, 0, nullptr, 0};
  lws_context_creation_info info{};
  info.port = address_.port;
  info.iface = address_.host.c_str();
  info.protocols = protocols_.data();
  info.user = this;
  info.gid = -1;
  info.uid = -1;
  info.fd_limit_per_thread = kMostConnections;
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  if (address_.host.find(':') == std::string::npos) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  const SignalsBlocked blocked;
  context_ = lws_create_context(&info);
  lws_vhost* const host = context_ != nullptr ? lws_get_vhost_by_name(context_, "default") : nullptr;
  if (host == nullptr || lws_get_vhost_listen_port(host) <= 0) {
    if (context_ != nullptr) lws_context_destroy(context_);
    throw FileError("--page " + address,
                    "cannot be served: another program may have this port, or it is no address here");
  }
  address_.port = lws_get_vhost_listen_port(host);
  thread_ = std::thread([this] {
    while (!is_ending_ && lws_service(context_, 0) >= 0) {
    }
  });
}

PageServer::~PageServer() {
  is_ending_ = true;
  lws_cancel_service(context_);
  thread_.join();
  lws_context_destroy(context_);
}

void PageServer::show(ShownScan scan) {
  const std::lock_guard lock(mutex_);
  scan_ = std::move(scan);
}

// A map before the first scan defines the page's frame, because its numbers have 24 bits.
void PageServer::show(const OccupancyMap& map, const Trajectory& path) {
  PageDrive drive;
  {
    const std::lock_guard lock(mutex_);
    if (!scan_) drive_.origin_m = {map.geometry.origin_x_m, map.geometry.origin_y_m};
    drive = drive_;
  }
  std::string message = map_message(drive, map, path);
  const std::lock_guard lock(mutex_);
  map_ = std::move(message);
  ++drive_.map;
}

std::optional<Answer> PageServer::answer_for(std::string_view path) {
  constexpr std::string_view kScan = "/scan/";  // followed by the number of the scan that the page has
  const std::lock_guard lock(mutex_);
  if (path == "/") return Answer{.body = live_page_text(drive_, title_), .type = "text/html; charset=utf-8"};
  if (path == "/map" && drive_.map > 0) return Answer{.body = map_, .is_compressed = true};
  if (!path.starts_with(kScan)) return std::nullopt;
  asked_ = PageClock::now();
  std::uint64_t known = 0;
  std::from_chars(path.data() + kScan.size(), path.data() + path.size(), known);
  return Answer{.body = scan_message(drive_, scan_ && scan_->scan != known ? &*scan_ : nullptr)};
}

int PageServer::begin_answer(lws* connection, std::string_view path) {
  const auto refuse = [connection](unsigned int status) {
    const bool is_over = lws_return_http_status(connection, status, nullptr) != 0;
    return is_over || lws_http_transaction_completed(connection) != 0 ? -1 : 0;
  };
  const std::string origin = header_text(connection, WSI_TOKEN_ORIGIN);
  if (!may_ask(address_, header_text(connection, WSI_TOKEN_HOST), origin)) return refuse(HTTP_STATUS_FORBIDDEN);
  std::optional<Answer> answer = answer_for(path);
  if (!answer) return refuse(HTTP_STATUS_NOT_FOUND);
  std::array<unsigned char, LWS_PRE + 2048> room{};
  unsigned char* const begin = room.data() + LWS_PRE;
  unsigned char* at = begin;
  unsigned char* const end = room.data() + room.size() - 1;
  const auto add = [&](const char* name, std::string_view value) {
    return lws_add_http_header_by_name(connection, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(value.data()),
                                       static_cast<int>(value.size()), &at, end) != 0;
  };
  if (lws_add_http_common_headers(connection, HTTP_STATUS_OK, answer->type, answer->body.size(), &at, end) != 0 ||
      (answer->is_compressed && add("content-encoding:", "deflate")) ||
      add("content-security-policy:", "frame-ancestors 'none'") || add("x-content-type-options:", "nosniff") ||
      add("cross-origin-resource-policy:", "same-origin") || add("referrer-policy:", "no-referrer") ||
      add("cache-control:", "no-store") || lws_finalize_write_http_header(connection, begin, &at, end) != 0) {
    return 1;
  }
  bodies_[connection] = std::string(LWS_PRE, '\0') + answer->body;
  lws_callback_on_writable(connection);
  return 0;
}

int PageServer::finish_answer(lws* connection) {
  auto body = bodies_.extract(connection);
  if (body.empty()) return 0;
  auto* const begin = reinterpret_cast<unsigned char*>(body.mapped().data()) + LWS_PRE;
  if (lws_write(connection, begin, body.mapped().size() - LWS_PRE, LWS_WRITE_HTTP_FINAL) < 0) return 1;
  return lws_http_transaction_completed(connection) != 0 ? -1 : 0;
}

int PageServer::on_event(lws* connection, lws_callback_reasons reason, void* session, void* data, std::size_t size) {
  auto* const server = static_cast<PageServer*>(lws_context_user(lws_get_context(connection)));
  switch (reason) {
    case LWS_CALLBACK_HTTP:
      return server->begin_answer(connection, static_cast<const char*>(data));
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return server->finish_answer(connection);
    case LWS_CALLBACK_CLOSED_HTTP:
      server->bodies_.erase(connection);
      return 0;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return 1;  // no websockets
    default:
      return lws_callback_http_dummy(connection, reason, session, data, size);
  }
}

}  // namespace

std::unique_ptr<LivePage> open_page(const std::string& address, const std::string& title) {
  return std::make_unique<PageServer>(address, title);
}

}  // namespace gdtslam
