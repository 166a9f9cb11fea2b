// What `gdtslam live` says on standard error: as on standard output, a reader that hangs stops no robot's map. A file
// or a pipe that is read gets every line, in order.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/io/log.hpp"
#include "output/line_output.hpp"

namespace gdtslam {

/// While it lives, what print_remark() and print_error() print goes through it, from any thread. One at a time.
class Remarks {
 public:
  explicit Remarks(int descriptor = STDERR_FILENO);
  Remarks(const Remarks&) = delete;
  Remarks& operator=(const Remarks&) = delete;
  /// Waits for a reader that goes on reading; what one leaves that does not is dropped.
  ~Remarks();

 private:
  LineOutput output_;
};

/// What whoever has a laser that nods should do, where these warnings tell of one.
void print_remark_on_nods(const std::vector<LogReader::Warning>& warnings);

}  // namespace gdtslam
