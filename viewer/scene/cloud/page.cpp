#include "gdtslam/viewer/page.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/base64.hpp"
#include "engine/core/to_position.hpp"
#include "engine/drawing/letters.hpp"
#include "engine/drawing/page/page_writer.hpp"
#include "gdtslam/cloud/plane.hpp"
#include "gdtslam/core/cloud.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/pose3.hpp"
#include "gdtslam/drawing/colour.hpp"
#include "viewer/scene/cloud/cloud_values.hpp"

namespace gdtslam {
namespace {

using namespace page;

// A cloud packed for a page, 12 bytes a point, little-endian: x, y, z and time in 16 bits, elevation, scan and distance
// in 8, each as a share of its range, and the level surface of the point. Thread-safe; O(points). Point k of the page
// is point (k * step) mod n of the n kept ones; step is coprime to n and near n / golden ratio. Any first part of the
// page's points is spread evenly over the log: slow machines draw that while the camera moves.

constexpr std::size_t kBytesPerPoint = 12;
constexpr std::size_t kPointsPerElement = std::size_t{1} << 18U;
/// 256 MB of page; browsers hold no text beyond 512 MB.
constexpr std::size_t kMostPoints = std::size_t{16} << 20U;

/// Range of a value over all kept points.
struct Range {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();
  double low = 0.0;   ///< 1st percentile without the ceiling's points
  double high = 0.0;  ///< 99th
  [[nodiscard]] double extent() const { return most - least; }
};

/// Floor and below, ceiling and above, with the margins of cloud pictures: lamps belong to the ceiling.
enum class LevelCode : std::uint8_t { kNone, kFloor, kCeiling };

constexpr std::size_t kSample = 200'000;  // points used to find the middle box
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kStrayShare = 0.001;          // at either end of each axis
constexpr double kGoldenShare = 0.6180339887;  // consecutive multiples fill a circle evenly

bool is_whole(const CloudPoint& point) {
  return is_finite(point) && std::isfinite(point.elevation_rad) && std::isfinite(point.stamp_s);
}

/// `value` as a share of the range in 0 to `steps`, rounded.
std::uint16_t quantised(double value, double least, double extent, double steps) {
  if (!(extent > 0.0)) return 0;
  const double share = std::clamp((value - least) / extent, 0.0, 1.0);
  return static_cast<std::uint16_t>(std::floor(share * steps + 0.5));
}
std::uint8_t quantised_byte(double value, const Range& range) {
  return static_cast<std::uint8_t>(quantised(value, range.least, range.extent(), 255.0));
}

Json describe(const Range& range) {
  return {{"least", range.least}, {"most", range.most}, {"low", range.low}, {"high", range.high}};
}

Json describe(const Point3& place) { return Json::array({place.x(), place.y(), place.z()}); }

class PagedCloud {
 public:
  /// Throws InputError if no point of the cloud is finite, for more than kMostPoints, or if distances and points differ
  /// in number.
  PagedCloud(const Cloud& cloud, const std::vector<float>* distances_m) : cloud_(cloud), distances_m_(distances_m) {
    if (distances_m != nullptr && distances_m->size() != cloud.size()) {
      throw InputError("a page needs one distance for each point: " + std::to_string(distances_m->size()) + " for " +
                       std::to_string(cloud.size()) + " points");
    }
    if (cloud.size() > kMostPoints) {
      throw InputError("a page holds at most " + std::to_string(kMostPoints) + " points, not " +
                       std::to_string(cloud.size()) + ": thin the cloud");
    }
    keep_points();
    find_levels();
    measure();
  }

  [[nodiscard]] Json description() const {
    Json about{{"count", kept_.size()},
               {"of", cloud_.size()},
               {"step", step_},
               {"elements", elements()},
               {"least", describe(least_)},
               {"most", describe(most_)},
               {"middle_least", describe(middle_least_)},
               {"middle_most", describe(middle_most_)},
               {"height", describe(height_)},
               {"time", describe(time_)},
               {"elevation", describe(elevation_)},
               {"scan", describe(scan_)}};
    if (distances_m_ != nullptr && distance_.most >= distance_.least) about["distance"] = describe(distance_);
    const auto describe_level = [&](const char* key, const std::optional<Plane>& plane, std::uint64_t points) {
      const Point3 middle = 0.5 * (least_ + most_);
      if (plane) about[key] = {{"height", height_m(*plane, middle.head<2>())}, {"points", points}};
    };
    describe_level("floor", floor_, floor_points_);
    describe_level("ceiling", ceiling_, ceiling_points_);
    return about;
  }

  void add_points(PageData& page) const {
    std::uint64_t at = 0;
    for (std::size_t element = 0; element < elements(); ++element) {
      const std::size_t begin = element * kPointsPerElement;
      const std::size_t end = std::min(begin + kPointsPerElement, kept_.size());
      ByteWriter bytes(kBytesPerPoint * (end - begin));
      for (std::size_t k = begin; k < end; ++k) {
        append_point(kept_[at], bytes);
        at = (at + step_) % kept_.size();
      }
      add_element(page, "points-" + std::to_string(element), bytes.bytes());
    }
  }

  [[nodiscard]] std::size_t elements() const { return (kept_.size() + kPointsPerElement - 1) / kPointsPerElement; }
  [[nodiscard]] const Point3& least() const { return least_; }

 private:
  /// Keeps points within the middle 99.8 % of each axis, widened by their largest extent on all sides: a few outliers
  /// would coarsen the steps of all others.
  void keep_points() {
    std::vector<std::uint32_t> finite;
    for (std::size_t k = 0; k < cloud_.size(); ++k) {
      if (is_whole(cloud_[k])) finite.push_back(static_cast<std::uint32_t>(k));
    }
    if (finite.empty()) throw InputError("the cloud has no point that a page could show");
    Point3 low;
    Point3 high;
    const std::size_t stride = finite.size() / kSample + 1;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (std::size_t k = 0; k < finite.size(); k += stride) values.push_back(to_position(cloud_[finite[k]])[axis]);
      const double beyond =
          std::floor(kStrayShare * static_cast<double>(values.size() - 1));  // none if there are few points
      const double last = static_cast<double>(values.size() - 1);
      low[axis] = percentile(values, last > 0.0 ? beyond / last : 0.0);
      high[axis] = percentile(values, last > 0.0 ? (last - beyond) / last : 0.0);
    }
    middle_least_ = low;
    middle_most_ = high;
    const double reach = std::max((high - low).maxCoeff(), 1.0);
    least_.setConstant(std::numeric_limits<double>::infinity());
    most_ = -least_;
    for (const std::uint32_t index : finite) {
      const Point3 at = to_position(cloud_[index]);
      if ((at - low).minCoeff() < -reach || (at - high).maxCoeff() > reach) continue;
      kept_.push_back(index);
      least_ = least_.cwiseMin(at);
      most_ = most_.cwiseMax(at);
    }
    step_ = static_cast<std::uint64_t>(kGoldenShare * static_cast<double>(kept_.size())) | 1U;
    while (std::gcd(step_, static_cast<std::uint64_t>(kept_.size())) != 1) step_ += 2;
  }

  void measure() {
    height_ = find_range([&](std::uint32_t k) { return static_cast<double>(cloud_[k].z_m); });
    time_ = find_range([&](std::uint32_t k) { return cloud_[k].stamp_s; });
    elevation_ = find_range([&](std::uint32_t k) { return static_cast<double>(cloud_[k].elevation_rad); });
    scan_ = find_range([&](std::uint32_t k) { return static_cast<double>(cloud_[k].scan); });
    if (distances_m_ != nullptr) {
      distance_ = find_range([&](std::uint32_t k) { return static_cast<double>((*distances_m_)[k]); });
    }
  }

  void find_levels() {
    const LevelSurfaces surfaces = sampled_level_surfaces(cloud_);
    if (surfaces.floor) floor_ = surfaces.floor->plane;
    if (surfaces.ceiling) ceiling_ = surfaces.ceiling->plane;
    for (const std::uint32_t index : kept_) {
      const LevelCode level = point_level(cloud_[index]);
      floor_points_ += level == LevelCode::kFloor ? 1U : 0U;
      ceiling_points_ += level == LevelCode::kCeiling ? 1U : 0U;
    }
  }

  [[nodiscard]] LevelCode point_level(const CloudPoint& point) const {
    if (floor_ && floor_->distance_m(to_position(point)) <= kFloorMargin_m) return LevelCode::kFloor;
    if (ceiling_ && ceiling_->distance_m(to_position(point)) >= -kCeilingMargin_m) return LevelCode::kCeiling;
    return LevelCode::kNone;
  }

  template <class ValueOf>
  [[nodiscard]] Range find_range(const ValueOf& value_at) const {
    Range range;
    for (const std::uint32_t index : kept_) {
      const double value = value_at(index);
      if (!std::isfinite(value)) continue;
      range.least = std::min(range.least, value);
      range.most = std::max(range.most, value);
    }
    std::vector<double> sample;
    for (const std::uint32_t index : kept_) {  // points drawn at first, the same as in a picture of the cloud
      const double value = point_level(cloud_[index]) == LevelCode::kCeiling ? kUnknown : value_at(index);
      if (std::isfinite(value)) sample.push_back(value);
    }
    if (!sample.empty()) {
      range.low = percentile(sample, 0.01);
      range.high = percentile(sample, 0.99);
    }
    return range;
  }

  void append_point(std::size_t index, ByteWriter& bytes) const {
    const CloudPoint& point = cloud_[index];
    const Point3 at = to_position(point);
    for (int axis = 0; axis < 3; ++axis) {
      bytes.u16(quantised(at[axis], least_[axis], most_[axis] - least_[axis], 65535.0));
    }
    bytes.u16(quantised(point.stamp_s, time_.least, time_.extent(), 65535.0));
    bytes.u8(quantised_byte(point.elevation_rad, elevation_));
    bytes.u8(quantised_byte(point.scan, scan_));
    if (distances_m_ == nullptr) {
      bytes.u8(0);
    } else {  // a point without a distance is beyond the search radius
      const double distance_m = static_cast<double>((*distances_m_)[index]);
      bytes.u8(std::isfinite(distance_m) ? quantised_byte(distance_m, distance_) : 255U);
    }
    bytes.u8(static_cast<std::uint8_t>(point_level(point)));
  }

  const Cloud& cloud_;
  const std::vector<float>* distances_m_;
  std::vector<std::uint32_t> kept_;  ///< indices into the cloud
  std::uint64_t step_ = 1;
  Point3 least_{0.0, 0.0, 0.0};
  Point3 most_{0.0, 0.0, 0.0};
  Point3 middle_least_{0.0, 0.0, 0.0};  ///< box of the middle 99.8 %, for the camera
  Point3 middle_most_{0.0, 0.0, 0.0};
  Range height_;
  Range time_;
  Range elevation_;
  Range scan_;
  Range distance_;
  std::optional<Plane> floor_;
  std::optional<Plane> ceiling_;
  std::uint64_t floor_points_ = 0;
  std::uint64_t ceiling_points_ = 0;
};

/// Names and 256 colours of all maps.
Json colour_maps_description() {
  Json maps = Json::array();
  for (const ColourMap& map : colour_maps()) {
    std::vector<std::uint8_t> bytes;
    for (const Colour& colour : map.table()) bytes.insert(bytes.end(), {colour.red, colour.green, colour.blue});
    std::string colours;
    append_base64(std::as_bytes(std::span(bytes)), colours);
    maps.push_back({{"name", map.name()}, {"doc", map.doc()}, {"colours", colours}});
  }
  return maps;
}

/// The default maps for a dark and a light background, as in cloud pictures.
Json default_maps() {
  Json maps;
  for (const bool is_dark : {true, false}) {
    CloudLook look;
    look.is_dark = is_dark;
    maps[is_dark ? "dark" : "light"] = colour_scale(look, CloudValues(look.colour, {}, {}), {}).colour_map;
  }
  return maps;
}

PageData page_data(const PageInput& input) {
  PageData data;
  Json& about = data.description;
  about["title"] = legible(input.title);
  about["subtitle"] = legible(input.subtitle);
  about["facts"] = Json::array();
  for (const auto& [name, value] : input.facts) about["facts"].push_back({legible(name), legible(value)});
  Point3 origin(0.0, 0.0, 0.0);
  if (input.cloud != nullptr && !input.cloud->empty()) {
    const PagedCloud cloud(*input.cloud, input.distances_m);
    origin = cloud.least();
    about["cloud"] = cloud.description();
    cloud.add_points(data);
    about["colour_maps"] = colour_maps_description();
    about["default_maps"] = default_maps();
  } else if (input.map != nullptr) {
    origin = {input.map->geometry.origin_x_m, input.map->geometry.origin_y_m, 0.0};
  } else if (input.trajectory != nullptr && !input.trajectory->empty() &&
             input.trajectory->front().T_map_base.is_finite()) {
    origin.head<2>() = input.trajectory->front().T_map_base.translation();
  }
  about["origin"] = {origin.x(), origin.y(), origin.z()};
  if (input.trajectory != nullptr) write_path(*input.trajectory, input.drives, origin.head<2>(), data);
  if (input.map != nullptr) write_map(*input.map, data);
  if (input.linkage != nullptr) write_linkage(*input.linkage, data);
  return data;
}

}  // namespace

std::string make_page(const PageInput& input) {
  const bool has_cloud = input.cloud != nullptr && !input.cloud->empty();
  const bool has_path = input.trajectory != nullptr && !input.trajectory->empty();
  const bool has_map = input.map != nullptr && input.map->geometry.cell_count() > 0;
  if (!has_cloud && !has_path && !has_map && input.linkage == nullptr) {
    throw InputError("there is nothing to show: a page needs a cloud, a path, a map or a linkage");
  }
  return page_text(page_data(input), "img-src data: blob:");
}

}  // namespace gdtslam
