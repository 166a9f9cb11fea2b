// Names of the library itself: its version, statuses and doubts.
#include <array>
#include <utility>

#include "gdtslam.h"
#include "gdtslam/mapping/match.hpp"

const char* gdtslam_version(void) { return GDTSLAM_VERSION; }

const char* gdtslam_status_name(gdtslam_status status) {
  constexpr std::array<std::pair<gdtslam_status, const char*>, 9> kNames{
      {{GDTSLAM_OK, "done"},
       {GDTSLAM_FAILED, "failed"},
       {GDTSLAM_USAGE, "wrong usage"},
       {GDTSLAM_BAD_INPUT, "bad input"},
       {GDTSLAM_UNAVAILABLE, "not available"},
       {GDTSLAM_OUT_OF_MEMORY, "out of memory"},
       {GDTSLAM_INPUT_OUTPUT, "cannot read or write"},
       {GDTSLAM_BAD_CONFIG, "bad configuration"},
       {GDTSLAM_INTERRUPTED, "interrupted"}}};
  for (const auto& [known, name] : kNames) {
    if (known == status) return name;
  }
  return "unknown status";
}

const char* gdtslam_doubt_name(int32_t doubt) {
  if (doubt < GDTSLAM_DOUBT_NONE || doubt > GDTSLAM_DOUBT_FAR) return "unknown doubt";
  return gdtslam::to_string(static_cast<gdtslam::Doubt>(doubt)).data();  // a literal, so it ends in 0
}
