// The line on standard error while `gdtslam reproduce` works: what is in hand, how far that is, time left; without a
// terminal one line for each finished part. The time left is that of the weights, at the speed of what is done so far.
// One thread.
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "tools/gdtslam/shell/progress.hpp"

namespace gdtslam::reproduce {

class Progress {
 public:
  /// `parts`: to be made; `total_s`: weights of all that is to be done; `workers`: that share it.
  Progress(std::size_t parts, double total_s, unsigned workers, bool quiet);

  void begin(const std::string& name, double weight_s);
  /// Share of what has that name that is done.
  void update(const std::string& name, double share);
  /// It is done, with that CPU time. A drive is no part.
  void finish(const std::string& name, double cpu_s, bool is_part);
  void clear() { line_.clear(); }

  struct InHand {
    double weight_s = 0.0;
    double share = 0.0;
  };
  /// "fig8 42 %, fig14 3 %  (3 of 10 parts made, 1:10 min left)".
  static std::string text(const std::map<std::string, InHand>& in_hand, std::size_t made, std::size_t parts,
                          double left_s);

 private:
  [[nodiscard]] double left_s() const;
  void draw();

  std::size_t parts_;
  std::size_t made_ = 0;
  double total_s_;
  unsigned workers_;
  double done_s_ = 0.0;  ///< weight of what is finished
  std::map<std::string, InHand> in_hand_;
  bool quiet_;
  TerminalLine line_;
};

}  // namespace gdtslam::reproduce
