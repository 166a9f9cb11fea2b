#include "box_face.hpp"

#include <cmath>
#include <limits>

#include "position_of.hpp"

namespace gdtslam {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
constexpr double kGrazing = 1.0e-3;  // sine of a beam's angle to the plane below which it does not cross it

// Where the beam from the viewpoint to the point crosses the plane; the point's shadow where it lies behind.
void cross(FaceHit& hit, const FaceFrame& face, const Point3& from_origin, const Point3& viewpoint) {
  const Point3 eye = viewpoint - face.origin;
  const Point3 beam = from_origin - eye;
  const double slope = face.normal.dot(beam);
  if (!(slope < -kGrazing * beam.norm())) return;
  const Point3 at = eye - beam * (face.normal.dot(eye) / slope);
  hit.across_m = face.across.dot(at);
  hit.up_m = face.up.dot(at);
}

}  // namespace

std::vector<FaceHit> hits_of(std::span<const CloudPoint> cloud, const FaceFrame& face, const Span& across,
                             const Span& up, const std::optional<Point3>& viewpoint, double thickness_m) {
  std::vector<FaceHit> hits;
  for (const CloudPoint& point : cloud) {
    const Point3 d = position_of(point) - face.origin;
    FaceHit hit{kNowhere, kNowhere, -face.normal.dot(d), face.across.dot(d), face.up.dot(d)};
    if (viewpoint) {
      cross(hit, face, d, *viewpoint);
    } else if (std::fabs(hit.depth_m) <= thickness_m) {
      hit.across_m = hit.point_across_m;
      hit.up_m = hit.point_up_m;
    }
    const bool crosses = across.has(hit.across_m) && up.has(hit.up_m);
    if (crosses || (across.has(hit.point_across_m) && up.has(hit.point_up_m))) hits.push_back(hit);
  }
  return hits;
}

}  // namespace gdtslam
