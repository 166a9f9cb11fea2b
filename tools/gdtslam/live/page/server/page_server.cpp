// The page by libwebsockets: one thread serves HTTP and websockets.
#include <fmt/format.h>
#include <libwebsockets.h>

#include <array>
#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "engine/core/signals_blocked.hpp"
#include "gdtslam/core/error.hpp"
#include "page_address.hpp"
#include "page_messages.hpp"
#include "tools/gdtslam/live/page/live_page.hpp"

namespace gdtslam {
namespace {

constexpr lws_usec_t kBetweenScans_us = 50000;
constexpr lws_usec_t kLongestSilence_us = 2000000;
constexpr const char* kProtocol = "gdtslam-live";
// The drive needs descriptors, too, of which a process has 1,024 as a rule: visitors beyond wait, or are sent away.
constexpr unsigned kMostConnections = 128;
constexpr int kMostWatching = 64;

/// A message with the room before it that the library asks for; none yet with version 0.
struct Message {
  std::uint64_t version = 0;
  std::string padded;

  void set(const std::string& text) {
    padded.assign(LWS_PRE, '\0');
    padded += text;
    ++version;
  }
  int write(lws* connection, lws_write_protocol kind) {
    auto* const begin = reinterpret_cast<unsigned char*>(padded.data()) + LWS_PRE;
    return lws_write(connection, begin, padded.size() - LWS_PRE, kind);
  }
};

/// What a connection has got; made by the library, of zeros.
struct Session {
  std::uint64_t scan;
  std::uint64_t map;
  std::uint64_t sign_of_life;
  bool is_after_map;
  bool is_counted;  // one that was sent away is closed, too
};

std::string random_name() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}", random(), random());
}

class PageServer final : public LivePage {
 public:
  PageServer(const std::string& address, const std::string& title);
  ~PageServer() override;

  [[nodiscard]] std::string url() const override { return url_; }
  [[nodiscard]] bool is_watched() const override { return sessions_ > 0; }
  void show(ShownScan scan) override;
  void show(const OccupancyMap& map, const Trajectory& path) override;

 private:
  /// The library's timer, and whose it is.
  struct Timer {
    lws_sorted_usec_list_t list{};
    PageServer* server = nullptr;
  };

  static int on_event(lws* connection, lws_callback_reasons reason, void* session, void* data, std::size_t size);
  static void on_time(lws_sorted_usec_list_t* list);
  int handle(lws* connection, lws_callback_reasons reason, Session* session, const char* path);
  int answer_request(lws* connection, std::string_view path);
  int write_next(lws* connection, Session& session);
  [[nodiscard]] bool may_ask_here(lws* connection) const;
  void take_news();

  PageAddress address_;
  std::string drive_ = random_name();
  std::string title_;
  std::string url_;
  std::array<lws_protocols, 2> protocols_{};
  lws_context* context_ = nullptr;
  Timer timer_;
  Message page_;  // the thread's, as the next five
  Message scan_;
  Message map_;
  Message sign_of_life_;
  lws_usec_t last_message_us_ = 0;
  std::atomic<int> sessions_ = 0;
  std::atomic<bool> is_ending_ = false;
  // Of both, under the lock:
  std::mutex mutex_;
  std::optional<ShownScan> new_scan_;
  std::string new_map_;
  std::thread thread_;
};

// Whole, however long: a header that passed for none because it fits nowhere would pass every check.
std::string header_of(lws* connection, lws_token_indexes name) {
  const int size = lws_hdr_total_length(connection, name);
  if (size <= 0) return {};
  std::string text(static_cast<std::size_t>(size) + 1, '\0');
  const int copied = lws_hdr_copy(connection, text.data(), static_cast<int>(text.size()), name);
  if (copied < 0) return "?";  // no host and no origin has this name
  text.resize(static_cast<std::size_t>(copied));
  return text;
}

PageServer::PageServer(const std::string& address, const std::string& title)
    : address_(page_address_of(address)), title_(title) {
  lws_set_log_level(0, nullptr);
  page_.set(live_page_text(title));
  sign_of_life_.set(sign_of_life_message(drive_, title_));
  protocols_[0] = {kProtocol, &PageServer::on_event, sizeof(Session), 0, 0, nullptr, 0};
  lws_context_creation_info info{};
  info.port = address_.port;
  info.iface = address_.host.c_str();
  info.protocols = protocols_.data();
  info.user = this;
  info.gid = -1;
  info.uid = -1;
  info.fd_limit_per_thread = kMostConnections;
  info.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  const bool has_colons = address_.host.find(':') != std::string::npos;
  if (!has_colons) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  const SignalsBlocked blocked;
  context_ = lws_create_context(&info);
  lws_vhost* const host = context_ != nullptr ? lws_get_vhost_by_name(context_, "default") : nullptr;
  if (host == nullptr || lws_get_vhost_listen_port(host) <= 0) {
    if (context_ != nullptr) lws_context_destroy(context_);
    throw FileError("--page " + address,
                    "cannot be served: another program may have this port, or it is no address here");
  }
  url_ = fmt::format("http://{}:{}/", has_colons ? "[" + address_.host + "]" : address_.host,
                     lws_get_vhost_listen_port(host));
  timer_.server = this;
  lws_sul_schedule(context_, 0, &timer_.list, &PageServer::on_time, kBetweenScans_us);
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
  new_scan_ = std::move(scan);
}

void PageServer::show(const OccupancyMap& map, const Trajectory& path) {
  std::string message = map_message(map, path, drive_);
  const std::lock_guard lock(mutex_);
  new_map_ = std::move(message);
}

void PageServer::on_time(lws_sorted_usec_list_t* list) {
  auto* const timer = reinterpret_cast<Timer*>(list);  // whose first member it is
  if (timer->server->is_watched()) timer->server->take_news();
  lws_sul_schedule(timer->server->context_, 0, list, &PageServer::on_time, kBetweenScans_us);
}

void PageServer::take_news() {
  std::optional<ShownScan> scan;
  std::string map;
  {
    const std::lock_guard lock(mutex_);
    scan = std::exchange(new_scan_, std::nullopt);
    map.swap(new_map_);
  }
  const lws_usec_t now_us = lws_now_usecs();
  const bool is_silent = !scan && map.empty();
  if (is_silent && now_us - last_message_us_ < kLongestSilence_us) return;
  last_message_us_ = now_us;
  if (is_silent) sign_of_life_.set(sign_of_life_message(drive_, title_));
  if (scan) scan_.set(scan_message(*scan, drive_));
  if (!map.empty()) map_.set(map);
  lws_callback_on_writable_all_protocol(context_, protocols_.data());
}

bool PageServer::may_ask_here(lws* connection) const {
  return may_ask(address_, header_of(connection, WSI_TOKEN_HOST), header_of(connection, WSI_TOKEN_ORIGIN));
}

int PageServer::answer_request(lws* connection, std::string_view path) {
  const auto refuse = [connection](unsigned int status) {
    const bool is_over = lws_return_http_status(connection, status, nullptr) != 0;
    return is_over || lws_http_transaction_completed(connection) != 0 ? -1 : 0;
  };
  if (!may_ask_here(connection)) return refuse(HTTP_STATUS_FORBIDDEN);
  if (path != "/") return refuse(HTTP_STATUS_NOT_FOUND);
  std::array<unsigned char, LWS_PRE + 2048> room{};
  unsigned char* const begin = room.data() + LWS_PRE;
  unsigned char* at = begin;
  unsigned char* const end = room.data() + room.size() - 1;
  const auto add = [&](const char* name, std::string_view value) {
    return lws_add_http_header_by_name(connection, reinterpret_cast<const unsigned char*>(name),
                                       reinterpret_cast<const unsigned char*>(value.data()),
                                       static_cast<int>(value.size()), &at, end) != 0;
  };
  if (lws_add_http_common_headers(connection, HTTP_STATUS_OK, "text/html; charset=utf-8", page_.padded.size() - LWS_PRE,
                                  &at, end) != 0 ||
      add("content-security-policy:", live_page_policy()) || add("x-content-type-options:", "nosniff") ||
      add("cross-origin-resource-policy:", "same-origin") || add("referrer-policy:", "no-referrer") ||
      add("cache-control:", "no-store") || lws_finalize_write_http_header(connection, begin, &at, end) != 0) {
    return 1;
  }
  lws_callback_on_writable(connection);
  return 0;
}

// Which drive it is; the map, which the scan lies on; then a scan, however soon the next map comes.
int PageServer::write_next(lws* connection, Session& session) {
  struct Part {
    Message& message;
    std::uint64_t& written;
    lws_write_protocol kind;
  };
  Part map{map_, session.map, LWS_WRITE_BINARY};
  Part scan{scan_, session.scan, LWS_WRITE_TEXT};
  Part sign{sign_of_life_, session.sign_of_life, LWS_WRITE_TEXT};
  const bool has_turn = session.is_after_map;
  std::array<const Part*, 3> order{has_turn ? &scan : &map, has_turn ? &map : &scan, &sign};
  if (session.sign_of_life == 0) std::swap(order.front(), order.back());
  for (const Part* part : order) {
    if (part->written == part->message.version) continue;
    part->written = part->message.version;
    session.is_after_map = part == &map;
    if (part->message.write(connection, part->kind) < 0) return -1;
    lws_callback_on_writable(connection);
    return 0;
  }
  return 0;
}

int PageServer::handle(lws* connection, lws_callback_reasons reason, Session* session, const char* path) {
  switch (reason) {
    case LWS_CALLBACK_HTTP:
      return answer_request(connection, path);
    case LWS_CALLBACK_HTTP_WRITEABLE:
      if (page_.write(connection, LWS_WRITE_HTTP_FINAL) < 0) return 1;
      return lws_http_transaction_completed(connection) != 0 ? -1 : 0;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
      return may_ask_here(connection) && sessions_ < kMostWatching ? 0 : 1;
    case LWS_CALLBACK_ESTABLISHED:
      session->is_counted = true;
      ++sessions_;
      take_news();
      lws_callback_on_writable(connection);
      return 0;
    case LWS_CALLBACK_CLOSED:
      if (session != nullptr && session->is_counted) --sessions_;
      return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return write_next(connection, *session);
    default:
      return 0;
  }
}

int PageServer::on_event(lws* connection, lws_callback_reasons reason, void* session, void* data, std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_HTTP:
    case LWS_CALLBACK_HTTP_WRITEABLE:
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
    case LWS_CALLBACK_ESTABLISHED:
    case LWS_CALLBACK_CLOSED:
    case LWS_CALLBACK_SERVER_WRITEABLE: {
      auto* const server = static_cast<PageServer*>(lws_context_user(lws_get_context(connection)));
      return server->handle(connection, reason, static_cast<Session*>(session), static_cast<const char*>(data));
    }
    default:
      return lws_callback_http_dummy(connection, reason, session, data, size);
  }
}

}  // namespace

std::unique_ptr<LivePage> open_page(const std::string& address, const std::string& title) {
  return std::make_unique<PageServer>(address, title);
}

}  // namespace gdtslam
