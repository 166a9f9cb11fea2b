// Reads a log and casts a ray through a simulated room: the parts that need other packages to link.
#include <cmath>
#include <fstream>
#include <iostream>
#include <variant>

#include "gdtslam/io/log.hpp"
#include "gdtslam/sim/ray_caster.hpp"
#include "gdtslam/sim/scene.hpp"

int main() {
  std::ofstream("three_beams.log") << "# a log\nFLASER 3 1.0 2.0 3.0 0 0 0 0.5 0 0 10.0 host 10.0\n";
  const auto reader = gdtslam::open_log("three_beams.log", {});
  std::size_t beams = 0;
  while (const auto record = reader->next()) {
    if (const auto* scan = std::get_if<gdtslam::ScanRecord>(&*record)) beams = scan->scan.ranges_m.size();
  }

  gdtslam::sim::Scene scene;
  scene.boxes.push_back({.centre_m = {3.0, 0.0}, .size_m = {1.0, 1.0}});
  const gdtslam::sim::RayCaster caster(gdtslam::sim::triangulate(scene));
  gdtslam::sim::Ray ray;
  ray.origin_m = {0.0, 0.0, 0.5};
  ray.direction = {1.0, 0.0, 0.0};
  const auto hit = caster.cast(ray, 10.0);
  const double range_m = hit ? hit->range_m : -1.0;

  std::cout << beams << " beams, " << range_m << " m to the box\n";
  return beams == 3 && std::fabs(range_m - 2.5) < 1e-9 ? 0 : 1;
}
