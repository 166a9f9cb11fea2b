// The real logs that parts take in where they are there. Thread-safe.
#pragma once

#include <string>
#include <vector>

namespace gdtslam::reproduce {

struct RealLog {
  std::string name;       ///< "Intel Research Lab"
  std::string stem;       ///< "intel"
  std::string log;        ///< file
  std::string relations;  ///< file
};

/// Those of the folder (FOLDER or FOLDER/slam2d) among intel, fr079 and mit-csail, each as NAME.clf.gz with
/// NAME.relations.gz. Throws FileError where there is no such folder, or none of the logs in it. Nothing without a
/// folder.
std::vector<RealLog> real_logs(const std::string& folder);

}  // namespace gdtslam::reproduce
