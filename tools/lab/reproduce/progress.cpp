#include "progress.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tools/gdtslam/shell/console.hpp"

namespace gdtslam::reproduce {
namespace {

// Of what is done before its speed tells more than the weights do.
constexpr double kTelling_s = 2.0;

}  // namespace

Progress::Progress(std::size_t parts, double total_s, unsigned workers, bool quiet)
    : parts_(parts), total_s_(total_s), workers_(std::max(1U, workers)), quiet_(quiet), line_(quiet) {}

void Progress::begin(const std::string& name, double weight_s) {
  in_hand_[name] = {weight_s, 0.0};
  draw();
}

void Progress::update(const std::string& name, double share) {
  in_hand_[name].share = std::clamp(share, 0.0, 1.0);
  draw();
}

std::string Progress::text(const std::map<std::string, InHand>& in_hand, std::size_t made, std::size_t parts,
                           double left_s) {
  std::string text;
  for (const auto& [name, work] : in_hand)
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", name, 100.0 * work.share);
  return fmt::format("{}  ({} of {} parts made, {} left)", text, made, parts, time_left_text(left_s));
}

double Progress::left_s() const {
  double done_s = done_s_;
  for (const auto& [name, work] : in_hand_) done_s += work.share * work.weight_s;
  const double pace = done_s > kTelling_s ? line_.elapsed_s() / done_s : 1.0 / workers_;
  return pace * std::max(0.0, total_s_ - done_s);
}

void Progress::draw() {
  line_.draw([this](double /*elapsed_s*/) { return text(in_hand_, made_, parts_, left_s()); });
}

void Progress::finish(const std::string& name, double cpu_s, bool is_part) {
  done_s_ += in_hand_[name].weight_s;
  in_hand_.erase(name);
  made_ += is_part ? 1U : 0U;
  line_.clear();
  if (quiet_) return;
  const std::string left = made_ < parts_ ? fmt::format(", about {} left", time_left_text(left_s())) : "";
  print_remark(is_part ? fmt::format("{} made, {:.1f} s of CPU time ({} of {}{})", name, cpu_s, made_, parts_, left)
                       : fmt::format("{} simulated, {:.1f} s of CPU time", name, cpu_s));
}

}  // namespace gdtslam::reproduce
