// A socket that others connect to. Loopback or a name in the file system unless another address is given.
#pragma once

#include <string>

namespace gdtslam {

class ListeningSocket {
 public:
  /// unix:PATH, tcp:PORT or tcp:ADDRESS:PORT, the address a number, in brackets where it has colons. A socket that a
  /// process left that was killed is replaced. Throws UsageError, FileError.
  explicit ListeningSocket(const std::string& address);
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  /// The name in the file system goes with it.
  ~ListeningSocket();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// The next connection, or -1 where there is none any more.
  [[nodiscard]] int accept() const;

 private:
  void listen_at_path(const std::string& path);
  void listen_at_port(const std::string& host_and_port);
  [[noreturn]] void fail(const std::string& what);

  std::string address_;
  std::string path_;  // of its own in the file system
  int descriptor_ = -1;
};

}  // namespace gdtslam
