// Distances of a cloud's points from the true surfaces of its scene. Cost: some microseconds per point and core; the
// cloud is read in pieces. Results do not depend on the number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "engine/runs/evaluation/distance_histogram.hpp"
#include "engine/runs/evaluation/errors.hpp"

namespace gdtslam {

struct SceneErrorsJob {
  std::string cloud;
  std::string scene;  ///< a file, or the name of a scene in one of the folders
  std::vector<std::string> scene_folders;
  CloudFrame frame;
  std::string embree_isa{};                               ///< forces Embree's instruction set; results stay the same
  std::function<void(std::uint64_t, double)> progress{};  ///< points so far, share done
  std::function<bool()> stop{};                           ///< returns true to end early
};

struct SceneErrors {
  DistanceHistogram distances;
  std::uint64_t skipped = 0;  ///< points with a value that is not finite
  std::size_t triangles = 0;
  std::string scene_file;
  bool interrupted = false;
};

/// Throws InputError or FileError for the cloud, ConfigError or FileError for the scene; UnavailableError in a build
/// without the simulator.
SceneErrors scene_errors(const SceneErrorsJob& job);

}  // namespace gdtslam
