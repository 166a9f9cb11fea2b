// What of a recording is used for a map, and why: the choice that its reader made, in words. Thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>

#include "engine/io/log_contents.hpp"
#include "scan_assembler.hpp"

namespace gdtslam {

/// What was asked for, and the topics that were taken.
struct RecordingUses {
  const TopicChoice& choice;
  const std::string& odometry;                                    ///< empty: none, or transforms
  const std::string& crank;                                       ///< likewise
  const std::map<std::string, std::size_t, std::less<>>& lasers;  ///< numbers by their topics
};

/// Fills in uses, reasons, lasers, odometry and clocks.
void tell_uses(const RecordingUses& uses, const ScanAssembler& assembler, LogContents& contents);

}  // namespace gdtslam
