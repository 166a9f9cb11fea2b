// The pose of a scan in a map with a proof: branch and bound over a window of poses, best bound first, until no pose of
// the window can be better than the best one found by more than a gap. The cost is that of pose_cost.hpp (bilinear,
// distance), to the bit; docs/numerics.md, "Certified matching", derives the bounds. Frames: the window and the result
// are poses of the robot in the map, metres and radians; points are in cells in the robot's frame. Same result on every
// instruction set and with every device; with a time limit it depends on the clock. A prepared map may be shared
// between threads; they take turns with its device. No other code may use that device at the same time.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gdtslam/compute/kernel.hpp"
#include "gdtslam/core/grid_geometry.hpp"
#include "gdtslam/core/pose.hpp"
#include "gdtslam/mapping/config.hpp"
#include "gdtslam/mapping/global_field.hpp"

namespace gdtslam {

class Backend;
class BoundFields;
class DeviceBounds;

/// A distance field in memory, row-major; its two outermost rows and columns hold the cap. 1/256 cell.
struct FieldView {
  const std::uint16_t* cells = nullptr;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t stride = 0;
  CellIndex first_cell;  ///< lower left cell in map cells
  std::uint16_t cap = 0;
  double resolution_m = MapConfig{}.resolution_m;
};
/// A copy of a map on the CPU at one moment.
class FieldCopy {
 public:
  explicit FieldCopy(const GlobalField& map);
  /// Valid as long as this.
  [[nodiscard]] FieldView view() const;
  [[nodiscard]] std::size_t bytes() const { return cells_.size() * sizeof(std::uint16_t); }

 private:
  GridGeometry geometry_;
  CellIndex first_cell_;
  std::uint16_t cap_;
  std::vector<std::uint16_t> cells_;
};

/// A field, prepared for the bounds. The field's cells must outlive it and stay as they are.
class CertifiedMap {
 public:
  /// Window sizes that a field is prepared for: any size, up to some metres (a fifth of the time), or up to one metre
  /// (a tenth). All of them give the same proofs in any window, but the poses that they find may differ within the gap.
  enum Windows : std::uint8_t { kAnyWindows, kSmallWindows, kNearWindows };
  /// `isa` runs the kernels. If there is a `device`, which must outlive this, it bounds the first boxes of a search in
  /// a large window, all at once. The result is the same. Throws Error if the field is smaller than 4 x 4 cells or its
  /// edge does not hold the cap, InputError if it is larger than some 32,400 x 32,400 cells.
  CertifiedMap(const FieldView& field, Isa isa, Windows windows = kAnyWindows, Backend* device = nullptr);
  ~CertifiedMap();
  CertifiedMap(const CertifiedMap&) = delete;
  CertifiedMap& operator=(const CertifiedMap&) = delete;

  [[nodiscard]] const FieldView& field() const { return field_; }
  [[nodiscard]] const BoundFields& bounds() const { return *bounds_; }
  [[nodiscard]] Isa isa() const { return isa_; }
  /// nullptr without a device.
  [[nodiscard]] DeviceBounds* device() const { return device_.get(); }
  /// Searches that were launched on the device so far.
  [[nodiscard]] std::uint64_t device_launches() const;
  /// Memory of the prepared fields.
  [[nodiscard]] std::size_t bytes() const;
  /// Most bytes in use at once while a field of that size is prepared, without the field's own. O(1).
  static std::uint64_t most_bytes(std::uint64_t width, std::uint64_t height, Windows windows = kAnyWindows);

 private:
  FieldView field_;
  Isa isa_;
  std::unique_ptr<BoundFields> bounds_;
  std::unique_ptr<DeviceBounds> device_;
};

/// A box of poses; both ends included, so that a half width of 0 means one value. A half angle of pi or more means
/// every heading.
struct PoseWindow {
  Pose2 centre;
  double half_x_m = 1.0;
  double half_y_m = 1.0;
  double half_theta_rad = 0.35;
  [[nodiscard]] bool holds(const Pose2& pose) const;
};

/// Excluded poses: those near `around`, in position and in heading.
struct ExcludedPoses {
  Pose2 around;
  double within_m = 1.0;
  double within_rad = 0.35;
  [[nodiscard]] bool hold(const Pose2& pose) const;
};

/// A preference for poses near a mean; see PriorParams.
struct WindowPrior {
  Pose2 mean;
  float weight_xy = 0.0F;     ///< cost units per squared cell
  float weight_theta = 0.0F;  ///< cost units per squared radian
  float limit = 1.0e9F;       ///< cost units of either part
};

/// Limits of a search, its start poses and the excluded poses.
struct CertifiedOptions {
  double gap_m = 0.005;  ///< gap of the mean distance to be proven
  /// Cost units. A proof that no pose costs less than this is enough, however close the best pose found is to it.
  std::uint32_t wanted_bound = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t max_boxes = std::numeric_limits<std::uint64_t>::max();  ///< a batch may exceed it; at most 2^23 open at
                                                                        ///< a time in any case
  /// Whether max_boxes includes the boxes that cover the window. On a large map these alone exceed any useful limit. If
  /// false, only boxes beyond these count.
  bool counts_window = true;
  double max_seconds = std::numeric_limits<double>::infinity();
  std::vector<Pose2> starts{};  ///< poses to begin from, such as another matcher's result
  std::optional<WindowPrior> prior{};
  std::vector<ExcludedPoses> excluded{};
};

/// Why a search ended. kBoundReached: the wanted bound is proven, not the gap. kResolution: boxes became so small that
/// rounding alone fills the gap.
enum class CertifiedStop : std::uint8_t {
  kGapReached,
  kBoundReached,
  kBoxLimit,
  kTimeLimit,
  kResolution,
  kNothingAllowed
};
std::string_view to_string(CertifiedStop stop);

/// The best pose of a search and its proof.
struct CertifiedResult {
  Pose2 T_map_base;          ///< the best pose found
  std::uint32_t cost = 0;    ///< its cost, prior included, 1/256 cell summed over the points
  std::uint32_t bound = 0;   ///< no pose of the window costs less
  double mean_cost_m = 0.0;  ///< cost, bound and gap per point
  double mean_bound_m = 0.0;
  double gap_m = 0.0;
  std::uint64_t boxes = 0;  ///< boxes with a computed bound
  std::uint64_t evaluations = 0;
  CertifiedStop stop = CertifiedStop::kNothingAllowed;
  [[nodiscard]] bool certified() const { return stop == CertifiedStop::kGapReached; }
};

/// At most this many points: PoseMinorant::kMostPoints.
inline constexpr std::size_t kMostCertifiedPoints = 4096;

/// Throws Error without points, with too many of them or with a window, prior or start that is not finite, DeviceError
/// if the map's device fails; a map without a device then gives the result. Cost: about 1 ms for a window of +-1 m and
/// +-20 degrees, 5 ms for +-5 m and all headings in the map of an office floor (docs/benchmarks.md, "Certified
/// matching").
CertifiedResult find_pose(const CertifiedMap& map, std::span<const PointCells> points, const PoseWindow& window,
                          const CertifiedOptions& options = {});

}  // namespace gdtslam
