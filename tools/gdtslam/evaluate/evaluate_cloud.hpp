// The part of `gdtslam evaluate` that judges a cloud: against the surfaces of a scene, or each point against the true
// hit of its beam.
#pragma once

#include <string>

namespace gdtslam {

struct EvaluateCloudOptions {
  std::string cloud;
  std::string scene;       ///< one of these two
  std::string hits;        ///< likewise
  std::string trajectory;  ///< of the run that made the cloud; with `reference`, else both frames are the same
  std::string reference;
  std::string linkage;     ///< with hits: for the quantisation bound
  std::string resolution;  ///< of the ranges, a length; with linkage
  std::string csv;
  double tolerance_s = -1.0;  ///< negative: the default
  bool no_align = false;
  bool json = false;
};

/// Prints the result; returns the exit code. Throws as scene_errors() and hit_errors(), UsageError.
int evaluate_cloud(const EvaluateCloudOptions& options);

}  // namespace gdtslam
