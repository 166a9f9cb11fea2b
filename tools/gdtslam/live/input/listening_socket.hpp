// A socket that others connect to. Loopback or a name in the file system unless another address is given.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace gdtslam {

class ListeningSocket {
 public:
  /// unix:PATH, tcp:PORT or tcp:ADDRESS:PORT, the address a number, in brackets where it has colons. A socket that a
  /// process left that was killed is replaced. Throws UsageError, FileError.
  explicit ListeningSocket(const std::string& address);
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  /// The name in the file system goes with it, unless it is another socket's by then.
  ~ListeningSocket();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// The next connection, or -1 where there is none any more.
  [[nodiscard]] int accept() const;

 private:
  /// Of what has a name in the file system.
  struct Identity {
    dev_t device = 0;
    ino_t number = 0;
    friend bool operator==(const Identity&, const Identity&) = default;
  };
  static std::optional<Identity> identity_of(const std::string& path);

  void listen_at_path(const std::string& path);
  void clear_name(const std::string& path);
  void close();
  void listen_at_port(const std::string& host_and_port);
  void tell_port(const std::string& host) const;
  [[noreturn]] void fail(const std::string& what);

  std::string address_;
  std::string path_;  // of its own in the file system, and what was made there
  std::optional<Identity> made_;
  int descriptor_ = -1;
};

}  // namespace gdtslam
