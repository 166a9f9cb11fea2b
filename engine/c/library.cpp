// What the library says of itself.
#include "gdtslam.h"
#include "gdtslam/mapping/match.hpp"

const char* gdtslam_version(void) { return GDTSLAM_VERSION; }

const char* gdtslam_status_name(gdtslam_status status) {
  switch (status) {
    case GDTSLAM_OK:
      return "done";
    case GDTSLAM_FAILED:
      return "failed";
    case GDTSLAM_USAGE:
      return "wrong usage";
    case GDTSLAM_BAD_INPUT:
      return "bad input";
    case GDTSLAM_UNAVAILABLE:
      return "not available";
    case GDTSLAM_OUT_OF_MEMORY:
      return "out of memory";
    case GDTSLAM_INPUT_OUTPUT:
      return "cannot read or write";
    case GDTSLAM_BAD_CONFIG:
      return "bad configuration";
    case GDTSLAM_INTERRUPTED:
      return "interrupted";
    default:
      return "unknown status";
  }
}

const char* gdtslam_doubt_name(int32_t doubt) {
  if (doubt < GDTSLAM_DOUBT_NONE || doubt > GDTSLAM_DOUBT_FAR) return "unknown doubt";
  return gdtslam::to_string(static_cast<gdtslam::Doubt>(doubt)).data();  // of a literal
}
