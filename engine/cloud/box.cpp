#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "box_face.hpp"
#include "engine/core/elementary.hpp"
#include "engine/core/quantile.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kOuterPart = 0.005;  // share of a face's points that lie beyond its rough ends
constexpr double kInner = 0.1;        // share at each end of a face that is not used for the ends of the other axis
constexpr double kAround_m = 0.3;     // margin around a face, in which hits are collected
constexpr double kOnFace = 3.5;       // standard deviations of a point on the face
constexpr double kLeastOnFace_m = 5.0e-3;
constexpr double kStep_m = 0.03;  // step outwards, if a face continues beyond its patch
constexpr int kSteps = 6;
constexpr std::size_t kLargeShare = 10;  // a floor has at least a tenth of the points of the largest level plane
constexpr double kOnFloor_m = 0.05;      // height of the lowest points of a face that is seen down to the floor
constexpr double kInBox_m = 0.05;        // a face whose centre is this close to a box is one of the box's own

/// A face that may become a box.
struct Face {
  FaceFrame frame;
  const PlanePatch* patch = nullptr;
  Span across;  ///< rough
  Span up;
  double sampling_m = 0.0;
  double thickness_m = 0.0;
  std::vector<FaceHit> hits;
};

// Normal of the line that the patch forms in the projection to the floor.
Point3 level_normal(std::span<const CloudPoint> cloud, const PlanePatch& patch) {
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  for (const std::uint32_t k : patch.points) {
    const Point3 d = to_position(cloud[k]) - patch.centre;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
  const SinCos<double> along = sin_cos(0.5 * atan2(2.0 * xy, xx - yy));
  return {-along.sin, along.cos, 0.0};
}

FaceFrame face_frame(std::span<const CloudPoint> cloud, const PlanePatch& patch, const BoxSearch& search) {
  FaceFrame frame;
  frame.origin = patch.centre;
  frame.normal = search.is_projection ? level_normal(cloud, patch) : patch.plane.normal;
  const Point3 eye = search.viewpoint.value_or(Point3(0.0, 0.0, patch.centre.z()));
  if (frame.normal.dot(eye - patch.centre) < 0.0) frame.normal = -frame.normal;
  frame.across = Point3::UnitZ().cross(frame.normal).normalized();
  frame.up = frame.normal.cross(frame.across);
  return frame;
}

// Spacing of the beams: between successive points of one scan; otherwise as if the points were spread evenly.
double estimate_sampling(std::span<const CloudPoint> cloud, const PlanePatch& patch, const Span& across,
                         const Span& up) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < patch.points.size(); ++k) {
    if (patch.points[k] != patch.points[k - 1] + 1) continue;
    const CloudPoint& a = cloud[patch.points[k - 1]];
    const CloudPoint& b = cloud[patch.points[k]];
    if (a.scan == b.scan) steps.push_back((to_position(a) - to_position(b)).norm());
  }
  const double even_m = std::sqrt(across.length_m() * up.length_m() / static_cast<double>(patch.points.size()));
  return steps.size() > patch.points.size() / 2 ? std::min(value_at_share(steps, 0.5), 0.1 * across.length_m())
                                                : even_m;
}

Face measure_face(std::span<const CloudPoint> cloud, const PlanePatch& patch, const BoxSearch& search) {
  Face face;
  face.patch = &patch;
  face.frame = face_frame(cloud, patch, search);
  std::vector<double> across;
  std::vector<double> up;
  for (const std::uint32_t k : patch.points) {
    const Point3 d = to_position(cloud[k]) - face.frame.origin;
    across.push_back(face.frame.across.dot(d));
    up.push_back(face.frame.up.dot(d));
  }
  face.across = {value_at_share(across, kOuterPart), value_at_share(across, 1.0 - kOuterPart)};
  face.up = {value_at_share(up, kOuterPart), value_at_share(up, 1.0 - kOuterPart)};
  face.sampling_m = estimate_sampling(cloud, patch, face.across, face.up);
  face.thickness_m = std::max(kLeastOnFace_m, std::min(kOnFace * patch.rms_m, search.planes.thickness_m * 1.5));
  return face;
}

bool can_be_face(const PlanePatch& patch, const BoxSearch& search) {
  return std::fabs(patch.plane.normal.z()) <= search.max_tilt_rad && patch.points.size() >= search.min_face_points;
}

EndPlace end_place(const Face& face, FaceAxis axis, double sign, const BoxSearch& search) {
  const Span& along = axis == FaceAxis::kAcross ? face.across : face.up;
  const Span& beside = axis == FaceAxis::kAcross ? face.up : face.across;
  EndPlace place{axis, sign, sign > 0.0 ? along.high_m : along.low_m, face.sampling_m, beside.inner(kInner), {}, 0.0};
  if (search.viewpoint) {
    const Point3 eye = *search.viewpoint - face.frame.origin;
    place.eye_along_m = (axis == FaceAxis::kAcross ? face.frame.across : face.frame.up).dot(eye);
    place.eye_before_m = face.frame.normal.dot(eye);
  }
  return place;
}

/// One end of the face and the face of the box that begins there, if it is seen.
struct End {
  EndPlace place;
  FaceEnd end;
  std::optional<SideFace> side;
  [[nodiscard]] bool is_seen() const { return end.kind == EndKind::kJump || end.kind == EndKind::kCrease; }
  [[nodiscard]] bool can_be_box() const { return is_seen() || end.kind == EndKind::kStops; }
};

End end_at(const Face& face, FaceAxis axis, double sign, const BoxSearch& search) {
  End found{end_place(face, axis, sign, search), {}, {}};
  found.end = find_end(face.hits, found.place, face.thickness_m);
  // The patch may end before the face does.
  for (int k = 0; k < kSteps && found.end.kind == EndKind::kContinues; ++k) {
    found.place.rough_m += sign * kStep_m;
    found.end = find_end(face.hits, found.place, face.thickness_m);
  }
  if (found.end.kind == EndKind::kContinues) return found;
  found.place.rough_m = found.end.at_m;
  found.side = side_at(face.hits, found.place, face.thickness_m, search.max_size_m);
  if (found.side) found.end = found.side->crease;
  return found;
}

// Depth of a side: it ends at the first beams along it that pass its far end.
Dimension measure_depth(std::span<const CloudPoint> cloud, const Face& face, const End& end, const BoxSearch& search) {
  const SideFace& side = *end.side;
  const bool is_up = end.place.axis == FaceAxis::kUp;
  const Point3 along = is_up ? face.frame.up : face.frame.across;
  FaceFrame frame;
  frame.origin = face.frame.origin + side.crease.at_m * along;
  frame.across = (-face.frame.normal + side.slope * along).normalized();  // back, along the side
  frame.up = is_up ? face.frame.across : face.frame.up;
  frame.normal = end.place.sign * (along + side.slope * face.frame.normal).normalized();
  const Span& beside = is_up ? face.across : face.up;
  const Span reach{-0.05, side.deepest_m + kAround_m};
  const double thickness_m = std::max(kLeastOnFace_m, kOnFace * side.rms_m);
  const std::vector<FaceHit> hits = find_hits(cloud, frame, reach, beside, search.viewpoint,
                                              search.viewpoint ? thickness_m : search.planes.thickness_m);
  std::vector<double> depths;
  for (const FaceHit& hit : hits) {
    if (hit.across_m > 0.0 && hit.across_m <= side.deepest_m + 0.05 && std::fabs(hit.depth_m) <= thickness_m)
      depths.push_back(hit.across_m);
  }
  if (depths.size() < search.min_face_points / 4 + 2) return {0.0, kUnknown, false};
  EndPlace place{FaceAxis::kAcross, 1.0, value_at_share(depths, 1.0 - kOuterPart), 0.0, beside.inner(kInner), {}, 0.0};
  place.sampling_m = std::max(face.sampling_m, 0.05 * place.rough_m);
  const FaceEnd far = find_end(hits, place, thickness_m);
  // An error of the side's position is enlarged by the low angle at which beams meet it.
  double stretch = 0.0;
  if (search.viewpoint) {
    const Point3 beam = frame.origin + far.at_m * frame.across - *search.viewpoint;
    stretch = std::fabs(frame.across.dot(beam) / frame.normal.dot(beam));
  }
  const double side_m = stretch * (side.crease.sigma_m + side.sigma_slope * far.at_m);
  const double face_m = face.patch->sigma_centre_m;
  const double sigma_m = std::sqrt(far.sigma_m * far.sigma_m + face_m * face_m + side_m * side_m);
  return {far.at_m, sigma_m, far.kind == EndKind::kJump || far.kind == EndKind::kCrease};
}

Dimension between(const End& low, const End& high) {
  const double sigma_m = std::sqrt(low.end.sigma_m * low.end.sigma_m + high.end.sigma_m * high.end.sigma_m);
  return {high.end.at_m - low.end.at_m, sigma_m, low.is_seen() && high.is_seen()};
}

// The lowest large level plane below the face. A row of beams far away, whose errors stay in the plane of its beams, is
// also a plane, with little noise even if it is tilted.
const PlanePatch* floor_below(const std::vector<PlanePatch>& planes, const Face& face, double max_tilt_rad) {
  const auto may_be_floor = [&](const PlanePatch& patch) {
    const double level = std::fabs(patch.plane.normal.z());
    return level * level >= 1.0 - max_tilt_rad * max_tilt_rad && patch.centre.z() < face.frame.origin.z();
  };
  std::size_t most = 0;
  for (const PlanePatch& patch : planes) {
    if (may_be_floor(patch)) most = std::max(most, patch.points.size());
  }
  const PlanePatch* floor = nullptr;
  for (const PlanePatch& patch : planes) {
    if (!may_be_floor(patch) || kLargeShare * patch.points.size() < most) continue;
    if (floor == nullptr || patch.centre.z() < floor->centre.z()) floor = &patch;
  }
  return floor;
}

// The lower end, at the floor if there is one: a box stands on it, even if the scanner did not see that far down.
End lower_end(const Face& face, const std::vector<PlanePatch>& planes, const BoxSearch& search) {
  End low{end_place(face, FaceAxis::kUp, -1.0, search), {}, {}};
  if (const PlanePatch* floor = floor_below(planes, face, search.max_tilt_rad)) {
    const Plane& plane = floor->plane;
    const double at_m = -plane.distance_m(face.frame.origin) / plane.normal.dot(face.frame.up);
    const bool is_seen = face.up.low_m - at_m <= kOnFloor_m;
    low.end = {at_m, floor->sigma_centre_m, is_seen ? EndKind::kCrease : EndKind::kHidden};
    return low;
  }
  low.end = {face.up.low_m, face.sampling_m, EndKind::kHidden};
  return low;
}

void set_place(MeasuredBox& box, const Face& face, const End& left, const End& right, const End& low, const End& high) {
  const Point3& along = face.frame.across;
  box.centre = face.frame.origin + 0.5 * (left.end.at_m + right.end.at_m) * along +
               0.5 * (low.end.at_m + high.end.at_m) * face.frame.up - 0.5 * box.depth.value_m * face.frame.normal;
  const double sign = along.x() < 0.0 || (along.x() == 0.0 && along.y() < 0.0) ? -1.0 : 1.0;
  box.yaw_rad = atan2(sign * along.y(), sign * along.x());
  box.face_normal = face.frame.normal;
  box.points = static_cast<std::uint32_t>(face.patch->points.size());
  box.face_rms_m = face.patch->rms_m;
}

std::optional<MeasuredBox> measure_box(std::span<const CloudPoint> cloud, Face face,
                                       const std::vector<PlanePatch>& planes, const BoxSearch& search) {
  face.hits = find_hits(cloud, face.frame, face.across.grown(kAround_m), face.up.grown(kAround_m), search.viewpoint,
                        face.thickness_m);
  const End left = end_at(face, FaceAxis::kAcross, -1.0, search);
  const End right = end_at(face, FaceAxis::kAcross, 1.0, search);
  const End high = end_at(face, FaceAxis::kUp, 1.0, search);
  const bool is_free = (left.is_seen() && right.end.kind != EndKind::kContinues) ||
                       (right.is_seen() && left.end.kind != EndKind::kContinues);
  if (search.viewpoint && (!is_free || !high.can_be_box())) return std::nullopt;
  const End low = lower_end(face, planes, search);
  MeasuredBox box;
  box.width = between(left, right);
  box.height = between(low, high);
  box.depth = {0.0, kUnknown, false};
  for (const End* end : {&left, &right, &high}) {
    if (!end->side) continue;
    const Dimension depth = measure_depth(cloud, face, *end, search);
    if (depth.sigma_m < box.depth.sigma_m) box.depth = depth;
  }
  const auto is_of_size = [&](double size_m) { return size_m >= search.min_size_m && size_m <= search.max_size_m; };
  if (!is_of_size(box.width.value_m) || !is_of_size(box.height.value_m)) return std::nullopt;
  set_place(box, face, left, right, low, high);
  return box;
}

// True if a face belongs to a box that was found by another of its faces.
bool is_of_box(const MeasuredBox& box, const Face& face) {
  const Point3 d = face.frame.origin - box.centre;
  const Point3 across = Point3::UnitZ().cross(box.face_normal).normalized();
  const double half_depth_m = std::max(0.5 * box.depth.value_m, 0.1);
  return std::fabs(d.dot(across)) <= 0.5 * box.width.value_m + kInBox_m &&
         std::fabs(d.dot(box.face_normal)) <= half_depth_m + kInBox_m &&
         std::fabs(d.z()) <= 0.5 * box.height.value_m + kInBox_m;
}

constexpr std::size_t kMostPoints = 200'000;
constexpr double kMostPlaneRms_m = 0.03;  // RMS of the points from the planes of their elevations
constexpr double kMostStretch = 0.03;     // deviation of the heading's length from 1
constexpr double kSteepest_rad = 1.4;     // beyond this, the elevation's error dominates the tangent
constexpr double kLeastSpread = 0.02;     // standard deviation of the elevations' tangents
constexpr double kLeastBoxPoints = 100;

struct Fit {
  Eigen::Vector4d answer = Eigen::Vector4d::Zero();
  double rms_m = 0.0;
  double spread = 0.0;  ///< standard deviation of the tangents
};

// z = height + tan(elevation) (x cos(heading) + y sin(heading) - forward), linear in the height, the heading's two
// components and the position along it.
std::optional<Fit> fit(std::span<const CloudPoint> cloud) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double count = 0.0;
  double squares = 0.0;
  double tangents = 0.0;
  double sq_tangents = 0.0;
  const std::size_t every = std::max<std::size_t>(1, cloud.size() / kMostPoints);
  for (std::size_t k = 0; k < cloud.size(); k += every) {
    const Point3 point = to_position(cloud[k]);
    const auto elevation_rad = static_cast<double>(cloud[k].elevation_rad);
    if (!point.allFinite() || !(std::fabs(elevation_rad) <= kSteepest_rad)) continue;
    const SinCos<double> elevation = sin_cos(elevation_rad);
    const double tangent = elevation.sin / elevation.cos;
    // Weighted by the cosine: the ratio of a point's distance from the plane to its error in height.
    const Eigen::Vector4d row =
        elevation.cos * Eigen::Vector4d(1.0, tangent * point.x(), tangent * point.y(), -tangent);
    normal += row * row.transpose();
    right += row * (elevation.cos * point.z());
    squares += elevation.cos * point.z() * elevation.cos * point.z();
    tangents += tangent;
    sq_tangents += tangent * tangent;
    count += 1.0;
  }
  if (count < kLeastBoxPoints) return std::nullopt;
  Fit result;
  result.answer = normal.ldlt().solve(right);
  result.rms_m = std::sqrt(std::fabs(squares - result.answer.dot(right)) / count);
  result.spread = std::sqrt(std::fabs(sq_tangents / count - tangents * tangents / (count * count)));
  return result;
}

}  // namespace

std::vector<MeasuredBox> find_boxes(std::span<const CloudPoint> cloud, const BoxSearch& search) {
  const std::vector<PlanePatch> planes = find_planes(cloud, search.planes);
  std::vector<MeasuredBox> boxes;
  for (const PlanePatch& patch : planes) {
    if (!can_be_face(patch, search)) continue;
    Face face = measure_face(cloud, patch, search);
    const auto is_known = [&face](const MeasuredBox& box) { return is_of_box(box, face); };
    if (face.across.length_m() > search.max_size_m || face.across.length_m() < 0.5 * search.min_size_m ||
        std::any_of(boxes.begin(), boxes.end(), is_known)) {
      continue;
    }
    if (const auto box = measure_box(cloud, std::move(face), planes, search)) boxes.push_back(*box);
  }
  std::stable_sort(boxes.begin(), boxes.end(),
                   [](const MeasuredBox& a, const MeasuredBox& b) { return a.width.value_m > b.width.value_m; });
  return boxes;
}

std::optional<Point3> standing_viewpoint(std::span<const CloudPoint> cloud) {
  const std::optional<Fit> found = fit(cloud);
  if (!found || !found->answer.allFinite() || found->spread < kLeastSpread || found->rms_m > kMostPlaneRms_m) {
    return std::nullopt;
  }
  const double length = std::sqrt(found->answer[1] * found->answer[1] + found->answer[2] * found->answer[2]);
  if (std::fabs(length - 1.0) > kMostStretch) return std::nullopt;
  const double forward_m = found->answer[3] / length;
  return Point3(forward_m * found->answer[1] / length, forward_m * found->answer[2] / length, found->answer[0]);
}

}  // namespace gdtslam
