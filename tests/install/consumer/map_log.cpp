// `gdtslam map LOG -o DIR` over the installed library: docs/howto/live.md shows these lines.
#include <cstdio>

#include <gdtslam/compute/backend.hpp>
#include <gdtslam/runs/map_log.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto backend = gdtslam::make_cpu_backend({});
  const auto result = gdtslam::map_logs({.logs = {argv[1]}, .folder = argv[2]}, *backend);
  std::printf("%zu poses\n", result.outcome.trajectory.size());
}
