// For builds without the page.
#include "gdtslam/core/error.hpp"
#include "tools/gdtslam/live/page/live_page.hpp"

namespace gdtslam {

std::unique_ptr<LivePage> open_page(const std::string& /*address*/, const std::string& /*title*/) {
  throw UnavailableError("this build has no page: it was configured without GDTSLAM_BUILD_LIVE_PAGE");
}

}  // namespace gdtslam
