#include "data.hpp"

#include <array>
#include <filesystem>
#include <system_error>

#include "gdtslam/core/error.hpp"

namespace gdtslam::reproduce {

std::vector<RealLog> real_logs(const std::string& folder) {
  namespace fs = std::filesystem;
  if (folder.empty()) return {};
  std::error_code failed;
  if (!fs::is_directory(folder, failed)) throw FileError(folder, "there is no such folder of real logs");
  constexpr std::array<std::array<const char*, 2>, 3> kKnown{
      {{"Intel Research Lab", "intel"}, {"Freiburg 079", "fr079"}, {"MIT CSAIL", "mit-csail"}}};
  for (const char* const below : {"", "/slam2d"}) {
    std::vector<RealLog> found;
    for (const auto& [name, stem] : kKnown) {
      const std::string start = folder + below + "/" + stem;
      if (fs::is_regular_file(start + ".clf.gz", failed) && fs::is_regular_file(start + ".relations.gz", failed))
        found.push_back({name, stem, start + ".clf.gz", start + ".relations.gz"});
    }
    if (!found.empty()) return found;
  }
  throw FileError(folder,
                  "holds none of intel.clf.gz, fr079.clf.gz and mit-csail.clf.gz with its NAME.relations.gz, nor does "
                  "slam2d in it");
}

}  // namespace gdtslam::reproduce
