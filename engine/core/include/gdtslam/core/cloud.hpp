// Points of a 3D cloud and the sink that receives them. Frame: map (x, y in the plane of the 2D map, z up), metres.
// Clouds may have tens of millions of points, so their producer passes them on in pieces and keeps none.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gdtslam {

/// One measured point with its origin.
struct CloudPoint {
  float x_m = 0.0F;
  float y_m = 0.0F;
  float z_m = 0.0F;
  float elevation_rad = 0.0F;  ///< elevation of the scan plane when the beam was fired, upwards positive
  double stamp_s = 0.0;        ///< when the beam was fired, in the log's clock
  std::uint32_t scan = 0;      ///< index of its scan in the log, from 0
  friend bool operator==(const CloudPoint&, const CloudPoint&) = default;
};

using Cloud = std::vector<CloudPoint>;

/// Receiver of the points of a cloud, in order, piece by piece.
class CloudSink {
 public:
  CloudSink() = default;
  CloudSink(const CloudSink&) = delete;
  CloudSink& operator=(const CloudSink&) = delete;
  virtual ~CloudSink() = default;
  /// The points are the caller's and may change after the call.
  virtual void add(std::span<const CloudPoint> points) = 0;
};

/// Keeps all points in memory.
class CloudKeeper : public CloudSink {
 public:
  void add(std::span<const CloudPoint> points) override { cloud.insert(cloud.end(), points.begin(), points.end()); }
  Cloud cloud;
};

}  // namespace gdtslam
