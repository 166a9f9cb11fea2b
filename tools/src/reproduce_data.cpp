#include "reproduce_data.hpp"

#include <filesystem>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam::reproduce {

std::vector<RealLog> real_logs(const std::string& folder) {
  namespace fs = std::filesystem;
  if (folder.empty()) return {};
  std::error_code failed;
  if (!fs::is_directory(folder, failed)) throw FileError(folder, "there is no such folder of real logs");
  for (const char* const below : {"", "/slam2d"}) {
    const RealLog intel{"Intel Research Lab", folder + below + "/intel.clf.gz", folder + below + "/intel.relations.gz"};
    if (fs::is_regular_file(intel.log, failed) && fs::is_regular_file(intel.relations, failed)) return {intel};
  }
  throw FileError(folder, "holds neither intel.clf.gz with intel.relations.gz nor slam2d with both");
}

}  // namespace gdtslam::reproduce
