#include "measure_run.hpp"

namespace gdtslam {
namespace {

void choose_viewpoint(const MeasureJob& job, std::span<const CloudPoint> cloud, Measurement& measured) {
  if (job.viewpoint) {
    measured.viewpoint = job.viewpoint;
    measured.viewpoint_source = ViewpointSource::kGiven;
  } else if (job.finds_viewpoint) {
    measured.viewpoint = standing_viewpoint(cloud);
    if (measured.viewpoint) measured.viewpoint_source = ViewpointSource::kFound;
  }
}

}  // namespace

Measurement measure_cloud(const MeasureJob& job, std::span<const CloudPoint> cloud) {
  Measurement measured;
  measured.cloud = job.cloud;
  measured.points = cloud.size();
  measured.has_boxes = job.boxes;
  measured.has_planes = job.planes;
  measured.is_projection = job.box_search.is_projection;
  if (job.boxes) {
    choose_viewpoint(job, cloud, measured);
    BoxSearch search = job.box_search;
    search.viewpoint = measured.viewpoint;
    measured.boxes = find_boxes(cloud, search);
  }
  if (job.planes) measured.planes = find_planes(cloud, job.plane_search);
  return measured;
}

}  // namespace gdtslam
