// Where the command keeps what it may lose: the pipelines that a driver built and the results of `gdtslam verify`.
#pragma once

#include <string>

namespace gdtslam {

struct CacheFolder {
  std::string path;     ///< empty where there is none
  std::string problem;  ///< why there is none
};

/// $XDG_CACHE_HOME/gdtslam, else ~/.cache/gdtslam, made with access for this user alone where it is missing. A home
/// that does not exist is not made: an account without one shall leave nothing behind.
CacheFolder cache_folder();

}  // namespace gdtslam
