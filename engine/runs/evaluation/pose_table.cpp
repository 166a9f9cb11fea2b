#include "pose_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "engine/io/byte_source.hpp"
#include "engine/io/decimal.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/line_reader.hpp"
#include "engine/io/message_text.hpp"
#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kFirstColumns = "scan,stamp_s,";
constexpr std::string_view kPoseColumns = ",ambiguous,x_m,y_m,theta_rad,";
constexpr std::string_view kCovarianceColumns = "xx_m2,xy_m2,xt_m_rad,yy_m2,yt_m_rad,tt_rad2,";
constexpr std::size_t kMostLineBytes = 4096;
constexpr double kZ = 1.959963984540054;  // two-sided, for 95 %

/// Reads the cells of a line in order.
class TableCells {
 public:
  TableCells(std::string_view line, FilePosition position) : rest_(line), position_(std::move(position)) {}

  std::string_view next() {
    if (rest_.data() == nullptr) refuse("has too few columns");
    const std::size_t end = rest_.find(',');
    const std::string_view cell = rest_.substr(0, end);
    rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
    return cell;
  }
  double number() {
    const std::string_view cell = next();
    double value = 0.0;
    const char* const end = cell.data() + cell.size();
    if (parse_double(cell.data(), end, value) != end || !std::isfinite(value)) {
      refuse(fmt::format("has {} where a finite number should be", in_quotes(cell)));
    }
    return value;
  }
  [[nodiscard]] bool is_next_empty() const { return rest_.starts_with(','); }
  [[noreturn]] void refuse(const std::string& fault) const {
    throw InputError(position_, fmt::format("the row {}; is it a table of 'gdtslam localize'?", fault));
  }

 private:
  std::string_view rest_;
  FilePosition position_;
};

FoundPose found_pose(TableCells cells, bool has_covariance) {
  constexpr double kMostScanNumber = 9.0e15;
  FoundPose pose;
  const double scan = cells.number();
  if (!(scan >= 0.0 && scan <= kMostScanNumber)) cells.refuse("does not begin with the number of a scan");
  pose.scan = static_cast<std::uint64_t>(scan);
  pose.stamp_s = cells.number();
  pose.state = cells.next();
  pose.is_ambiguous = cells.next() == "1";
  if (cells.is_next_empty()) return pose;
  const double x_m = cells.number();
  const double y_m = cells.number();
  pose.T_map_base = Pose2{x_m, y_m, cells.number()};
  if (!has_covariance) return pose;
  std::array<double, 6> c{};
  for (double& value : c) value = cells.number();
  pose.covariance = PoseCovariance{.xx = c[0], .xy = c[1], .xt = c[2], .yy = c[3], .yt = c[4], .tt = c[5]};
  return pose;
}

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

Interval wilson(const Share& share) {
  if (share.of == 0) return {};
  const auto k = static_cast<double>(share.count);
  const auto n = static_cast<double>(share.of);
  const double middle = (k + 0.5 * kZ * kZ) / (n + kZ * kZ);
  const double half = kZ * std::sqrt(k * (n - k) / n + 0.25 * kZ * kZ) / (n + kZ * kZ);
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

/// Counts right and wrong poses.
class PosesComparison {
 public:
  PosesComparison(const Pose2& T_truth_map, const PoseLimits& limits) : T_truth_map_(T_truth_map), limits_(limits) {}

  void add(const FoundPose& pose, const Pose2& T_truth_base) {
    Share& share = report_.states[pose.state];
    ++share.of;
    ++report_.within.of;
    if (!pose.T_map_base) return report_.wrong.push_back({pose.scan, pose.state, {}});
    const Pose2 aligned = T_truth_map_ * *pose.T_map_base;
    const double angle_rad = std::fabs(wrap_angle(aligned.theta_rad - T_truth_base.theta_rad));
    const TrajectoryError error{pose.stamp_s, (aligned.translation() - T_truth_base.translation()).norm(),
                                deg_from_rad(angle_rad)};
    if (!(error.position_m <= limits_.within_m && angle_rad <= limits_.within_rad)) {
      return report_.wrong.push_back({pose.scan, pose.state, error});
    }
    ++share.count;
    ++report_.within.count;
    distances_m_.push_back(error.position_m);
    angles_deg_.push_back(error.angle_deg);
    if (!pose.covariance) return;
    found_.push_back({pose.stamp_s, *pose.T_map_base});
    true_.push_back({pose.stamp_s, T_truth_base});
    covariances_.push_back(*pose.covariance);
  }
  PosesReport finish() && {
    report_.distance_m = summarise(distances_m_);
    report_.angle_deg = summarise(angles_deg_);
    if (!found_.empty()) report_.stated = stated_errors(found_, covariances_, true_, T_truth_map_, {}, 0.0);
    return std::move(report_);
  }

 private:
  Pose2 T_truth_map_;
  PoseLimits limits_;
  PosesReport report_;
  std::vector<double> distances_m_;
  std::vector<double> angles_deg_;
  Trajectory found_;
  Trajectory true_;
  std::vector<PoseCovariance> covariances_;
};

}  // namespace

double Share::value() const { return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0.0; }
double Share::low() const { return wilson(*this).low; }
double Share::high() const { return wilson(*this).high; }

bool is_pose_table(const std::string& path) {
  LineReader lines(gunzip_if_packed(open_file_source(path), path), kMostLineBytes);
  const std::optional<TextLine> line = lines.next();
  return line && line->text.starts_with(kFirstColumns) && line->text.find(kPoseColumns) != std::string_view::npos;
}

std::vector<FoundPose> read_pose_table(const std::string& path) {
  LineReader lines(gunzip_if_packed(open_file_source(path), path), kMostLineBytes);
  const std::optional<TextLine> header = lines.next();
  const bool has_covariance = header && header->text.find(kCovarianceColumns) != std::string_view::npos;
  std::vector<FoundPose> poses;
  while (const std::optional<TextLine> line = lines.next()) {
    const TableCells cells(line->text, {path, line->number});
    if (!line->has_newline || line->is_too_long) cells.refuse("is cut off, or too long");
    poses.push_back(found_pose(cells, has_covariance));
    check_kept_bytes(poses.size() * sizeof(FoundPose), lines.source().bytes_from_file(), path);
  }
  return poses;
}

PosesReport compare_poses(const std::vector<FoundPose>& poses, const Trajectory& truth, const Pose2& T_truth_map,
                          const PoseLimits& limits) {
  const PosesByStamp by_stamp(truth);
  const RepeatedStamps repeated(truth, limits.tolerance_s);
  PosesComparison comparison(T_truth_map, limits);
  std::uint64_t unmatched = 0;
  for (const FoundPose& pose : poses) {
    const std::optional<Pose2> T_truth_base =
        repeated.have(pose.stamp_s) ? std::nullopt : by_stamp.find(pose.stamp_s, limits.tolerance_s);
    if (T_truth_base) {
      comparison.add(pose, *T_truth_base);
    } else {
      ++unmatched;
    }
  }
  PosesReport report = std::move(comparison).finish();
  report.unmatched = unmatched;
  if (report.within.of > 0) return report;
  throw InputError(
      fmt::format("none of its {} poses has the stamp of one of the {} scans; do both belong to the same log?",
                  truth.size(), poses.size()));
}

std::vector<FoundPose> without_near(std::vector<FoundPose> poses, std::vector<double> stamps_s, double within_s) {
  std::sort(stamps_s.begin(), stamps_s.end());  // stamps of a log may step back
  std::erase_if(poses, [&](const FoundPose& pose) {
    const auto after = std::lower_bound(stamps_s.begin(), stamps_s.end(), pose.stamp_s - within_s);
    return after != stamps_s.end() && *after <= pose.stamp_s + within_s;
  });
  return poses;
}

}  // namespace gdtslam
