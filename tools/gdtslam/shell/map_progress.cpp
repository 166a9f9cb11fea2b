#include "map_progress.hpp"

#include <fmt/format.h>

namespace gdtslam {

void MapProgress::follow(MapRequest& request) {
  request.progress = [this](std::uint64_t done, double share) { scans_.update(done, share); };
  request.closing = [this](std::string_view step, double share) {
    scans_.clear();
    rest_.draw([&](double) { return fmt::format("{:4.0f} %  {}", 100.0 * share, step); });
  };
  request.finishing = [this](std::string_view what) { making(what); };
}

void MapProgress::making(std::string_view what) {
  scans_.clear();
  rest_.draw_now(fmt::format("making {}", what));
}

void MapProgress::clear() {
  scans_.clear();
  rest_.clear();
}

}  // namespace gdtslam
