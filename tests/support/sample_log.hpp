// The sample log: 350 scans of a simulated office, out into a room and back to the start, and the true pose of each.
#pragma once

#include <string>
#include <vector>

#include "gdtslam/io/trajectory_file.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam::test {

/// Without the endings of the log, .log.gz, and of its poses, .truth.tum.
inline const std::string kSampleLog = GDTSLAM_SOURCE_DIR "/assets/logs/office-start";

/// True motions over 2.7 s, and over 25 s or more, between which the robot has been elsewhere.
inline std::vector<Relation> true_relations() {
  const Trajectory truth = read_tum(kSampleLog + ".truth.tum");
  std::vector<Relation> relations;
  for (std::size_t i = 0; i < truth.size(); i += 5) {
    for (const std::size_t j : {i + 16, i + 150, i + 300}) {
      if (j >= truth.size()) continue;
      relations.push_back({truth[i].stamp_s, truth[j].stamp_s, between(truth[i].T_map_base, truth[j].T_map_base)});
    }
  }
  return relations;
}

}  // namespace gdtslam::test
