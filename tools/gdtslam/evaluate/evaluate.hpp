// What `gdtslam evaluate` is asked for, and the two things that it can evaluate. Thread-safe apart from the files.
#pragma once

#include <string>

#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

struct EvaluateOptions {
  std::string file;  ///< a run or a trajectory, or with scene or hits a cloud
  std::string relations;
  std::string reference;      ///< of a cloud: with `trajectory`, else both frames are the same
  double tolerance_s = -1.0;  ///< negative: the default
  double distance_m = ReferenceOptions{}.rpe_distance_m;
  bool no_align = false;
  std::string noise;  ///< of the truth, "2cm/0.5deg"; empty: none
  bool force = false;
  bool json = false;
  // Of a cloud.
  std::string scene;       ///< one of these two
  std::string hits;        ///< likewise
  std::string trajectory;  ///< of the run that made the cloud
  std::string linkage;     ///< with hits: for the quantisation bound
  std::string resolution;  ///< of the ranges, a length; with linkage
  std::string csv;
};

/// How stamps match and trajectories are aligned.
ReferenceOptions reference_options(const EvaluateOptions& options);

// Each prints its result and returns the exit code. Throws UsageError, InputError, FileError and what the truth needs.
int evaluate_trajectory(const EvaluateOptions& options);
int evaluate_cloud(const EvaluateOptions& options);

}  // namespace gdtslam
