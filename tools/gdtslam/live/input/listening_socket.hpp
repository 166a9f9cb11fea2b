// A socket that others connect to. Loopback or a name in the file system unless another address is given.
#pragma once

#include <sys/stat.h>

#include <string>

namespace gdtslam {

class ListeningSocket {
 public:
  /// unix:PATH, tcp:PORT or tcp:ADDRESS:PORT, the address a number, in brackets if it has colons. A socket that a
  /// killed process left is replaced. Throws UsageError, FileError.
  explicit ListeningSocket(const std::string& address);
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  /// The name in the file system goes with it, unless it is another socket's by then.
  ~ListeningSocket();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// The next connection, or -1 if there is none any more.
  [[nodiscard]] int accept() const;

 private:
  void listen_at_path(const std::string& path);
  void listen_at_port(const std::string& host_and_port);
  void bind_to(int family, const void* address, unsigned size);

  std::string address_;
  std::string path_;  // in the file system, once it is bound, and what was made there
  struct stat made_ {};
  int descriptor_ = -1;
};

}  // namespace gdtslam
