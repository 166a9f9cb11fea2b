#include "run_keyframes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/logs/gzip_file.hpp"
#include "engine/io/sha256.hpp"
#include "engine/mapping/changes/session_changes.hpp"
#include "engine/runs/keyframes/bytes.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr std::string_view kMagic = "gdtslam-keyframe";
constexpr std::uint32_t kKeyframeVersion = 1;
constexpr std::uint8_t kInSinglePrecision = 1;  // flag of the file
constexpr std::uint8_t kHasCovariance = 1;      // flag of a keyframe
constexpr std::uint8_t kHasSpeed = 2;
constexpr std::size_t kDigestDigits = 64;
constexpr std::uint32_t kMostRange_mm = 100'000'000;  // farther away no point counts
constexpr double kFarthestPose_m = 2.0e7;             // distance of two places on earth
constexpr std::size_t kMostKeyframeBytes = std::size_t{4} << 30U;
constexpr double kNoVariance = -1.0e-12;  // rounding of a zero in differences of large numbers
constexpr double kMmInMetre = 1000.0;

void append_pose(BytesOut& out, const Pose2& pose) { out.number(pose.x_m).number(pose.y_m).number(pose.theta_rad); }

Pose2 pose_from(BytesIn& in) {
  const double x_m = in.number("a pose");
  const double y_m = in.number("a pose");
  if (std::fmax(std::fabs(x_m), std::fabs(y_m)) > kFarthestPose_m) {
    in.refuse(
        fmt::format("has a pose at ({:g}, {:g}), which is no place: metres, {:g} at most", x_m, y_m, kFarthestPose_m));
  }
  return {x_m, y_m, in.number("a pose")};
}

// Appends zero for no return, else the step from the last return plus one, which is mostly small.
void append_ranges(BytesOut& out, const std::vector<float>& ranges_m) {
  out.whole(static_cast<std::uint32_t>(ranges_m.size()));
  std::int64_t last_mm = 0;
  for (const float range_m : ranges_m) {
    const std::int64_t mm = range_in_mm(range_m);
    if (mm == 0) {
      out.varint(0);
      continue;
    }
    const std::int64_t step = mm - last_mm;
    out.varint((static_cast<std::uint64_t>(step < 0 ? -step : step) << 1U | (step < 0 ? 1U : 0U)) + 1U);
    last_mm = mm;
  }
}

std::vector<float> ranges_from(BytesIn& in) {
  const std::uint32_t beams = in.count("beams", 1);
  std::vector<float> ranges_m;
  ranges_m.reserve(beams);
  std::int64_t last_mm = 0;
  for (std::uint32_t beam = 0; beam < beams; ++beam) {
    const std::uint64_t coded = in.varint();
    if (coded == 0) {
      ranges_m.push_back(std::numeric_limits<float>::infinity());
      continue;
    }
    const auto length = static_cast<std::int64_t>((coded - 1U) >> 1U);
    last_mm += ((coded - 1U) & 1U) != 0 ? -length : length;
    if (last_mm < 1 || last_mm > kMostRange_mm) in.refuse(fmt::format("has a range of {} mm", last_mm));
    ranges_m.push_back(static_cast<float>(static_cast<double>(last_mm) / kMmInMetre));
  }
  return ranges_m;
}

void append_covariance(BytesOut& out, const PoseCovariance& c) {
  out.number(c.xx).number(c.xy).number(c.xt).number(c.yy).number(c.yt).number(c.tt);
}

PoseCovariance covariance_from(BytesIn& in) {
  PoseCovariance c;
  for (double* value : {&c.xx, &c.xy, &c.xt, &c.yy, &c.yt, &c.tt}) *value = in.number("a covariance");
  if (c.xx < kNoVariance || c.yy < kNoVariance || c.tt < kNoVariance) in.refuse("has a variance below zero");
  return c;
}

void append_keyframe(BytesOut& out, const RunKeyframe& keyframe) {
  const LaserScan& laser = keyframe.laser;
  out.whole(static_cast<std::uint32_t>(keyframe.scan));
  out.byte(static_cast<std::uint8_t>((keyframe.covariance ? kHasCovariance : 0U) | (laser.speed ? kHasSpeed : 0U)));
  out.number(laser.stamp_s);
  append_pose(out, keyframe.T_map_base);
  if (keyframe.covariance) append_covariance(out, *keyframe.covariance);
  append_pose(out, laser.T_base_laser);
  out.number(laser.first_bearing_rad).number(laser.bearing_step_rad).number(laser.max_range_m);
  out.number(laser.first_beam_after_s).number(laser.beam_period_s);
  if (laser.speed) out.number(laser.speed->x()).number(laser.speed->y()).number(laser.speed->z());
  append_ranges(out, laser.ranges_m);
}

RunKeyframe keyframe_from(BytesIn& in) {
  RunKeyframe keyframe;
  LaserScan& laser = keyframe.laser;
  keyframe.scan = in.whole();
  const std::uint8_t flags = in.byte();
  if ((flags & ~(kHasCovariance | kHasSpeed)) != 0)
    in.refuse(fmt::format("has flags {} that nothing is known of", flags));
  laser.stamp_s = in.number("a stamp");
  keyframe.T_map_base = pose_from(in);
  if ((flags & kHasCovariance) != 0) keyframe.covariance = covariance_from(in);
  laser.T_base_laser = pose_from(in);
  laser.first_bearing_rad = in.number("a bearing");
  laser.bearing_step_rad = in.number("a bearing");
  laser.max_range_m = in.number("a range limit");
  laser.first_beam_after_s = in.number("a time");
  laser.beam_period_s = in.number("a time");
  if ((flags & kHasSpeed) != 0) {
    const double x = in.number("a speed");
    const double y = in.number("a speed");
    laser.speed.emplace(x, y, in.number("a speed"));
  }
  laser.ranges_m = ranges_from(in);
  return keyframe;
}

// The smallest keyframe: number, flags, stamp, pose, mount, five numbers of the laser, count of beams.
constexpr std::size_t kLeastKeyframeBytes = 4 + 1 + (1 + 3 + 3 + 5) * sizeof(double) + 4;

void read_start(BytesIn& in) {
  if (in.text(kMagic.size()) != kMagic) in.refuse("holds no keyframes of a run");
  if (const std::uint32_t version = in.whole(); version != kKeyframeVersion) {
    in.refuse(fmt::format("has version {}, and this program reads version {}", version, kKeyframeVersion));
  }
}

std::string digest_text(std::string_view bytes) { return Sha256().update(bytes).hex(); }

// The whole file, unpacked.
std::string unpacked(const std::string& path) {
  const std::unique_ptr<ByteSource> source = gunzip_if_packed(open_file_source(path), path);
  std::string bytes = read_all(*source, kMostKeyframeBytes, path);
  if (const std::string defect = source->defect(); !defect.empty()) {
    throw InputError({path, 0}, fmt::format("is cut or longer than it was written: {}", defect));
  }
  return bytes;
}

}  // namespace

std::uint32_t range_in_mm(float range_m) {
  const double mm = static_cast<double>(range_m) * kMmInMetre;
  if (!(mm >= 0.0 && mm < static_cast<double>(kMostRange_mm))) return 0;  // true for NaN too
  return static_cast<std::uint32_t>(std::fmax(1.0, std::floor(mm + 0.5)));
}

std::string keyframe_bytes(const RunKeyframes& run) {
  BytesOut out;
  out.text(kMagic).whole(kKeyframeVersion).text(run.config_sha256);
  out.byte(run.in_single_precision ? kInSinglePrecision : 0U);
  out.whole(static_cast<std::uint32_t>(run.keyframes.size()));
  for (const RunKeyframe& keyframe : run.keyframes) append_keyframe(out, keyframe);
  return out.take();
}

RunKeyframes parse_keyframes(std::string_view bytes, const std::string& name) {
  BytesIn in(bytes, name);
  read_start(in);
  RunKeyframes run;
  run.config_sha256 = in.text(kDigestDigits);
  if (run.config_sha256.find_first_not_of("0123456789abcdef") != std::string::npos) {
    in.refuse("has a hash of the configuration that is none");
  }
  const std::uint8_t flags = in.byte();
  if ((flags & ~kInSinglePrecision) != 0) in.refuse(fmt::format("has flags {} that nothing is known of", flags));
  run.in_single_precision = (flags & kInSinglePrecision) != 0;
  const std::uint32_t count = in.count("keyframes", kLeastKeyframeBytes);
  run.keyframes.reserve(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    RunKeyframe keyframe = keyframe_from(in);
    if (k > 0 && keyframe.scan <= run.keyframes.back().scan) {
      in.refuse(fmt::format("has scan {} after scan {}", keyframe.scan, run.keyframes.back().scan));
    }
    run.keyframes.push_back(std::move(keyframe));
  }
  if (in.left() > 0) in.refuse(fmt::format("goes on for {} bytes after its last keyframe", in.left()));
  return run;
}

std::string write_keyframes(const std::string& path, const RunKeyframes& run) {
  const std::string bytes = keyframe_bytes(run);
  std::string digest = digest_text(bytes);
  AtomicFile file(path);
  TextSink sink(file);
  sink.write(bytes);
  sink.write(digest);
  sink.finish();
  file.commit();
  return digest;
}

RunKeyframes read_keyframes(const std::string& path) {
  const std::string bytes = unpacked(path);
  BytesIn start(bytes, path);  // read first, because another version may have another checksum
  read_start(start);
  if (start.left() < kDigestDigits) start.refuse("ends within its header");
  const std::string_view body = std::string_view(bytes).substr(0, bytes.size() - kDigestDigits);
  if (bytes.compare(body.size(), kDigestDigits, digest_text(body)) != 0) {
    throw InputError({path, 0}, "is damaged: its checksum is that of other bytes");
  }
  return parse_keyframes(body, path);
}

namespace {

// A run with loops keeps its points in single precision until the end.
void round_to_floats(std::vector<Point2>& points) {
  for (Point2& point : points) point = point.cast<float>().cast<double>();
}

}  // namespace

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, std::span<const std::size_t> which,
                                              const MapperConfig& config) {
  auto map = std::make_unique<SeparateMap>(config);
  ScanPoints scan_points(config.scan);
  for (const std::size_t k : which) {
    const RunKeyframe& keyframe = run.keyframes[k];
    std::vector<Point2> points = scan_points.of(keyframe.laser);
    if (run.in_single_precision) round_to_floats(points);
    map->merge(points, keyframe.T_map_base);
  }
  return map;
}

std::unique_ptr<SeparateMap> map_of_keyframes(const RunKeyframes& run, const MapperConfig& config) {
  std::vector<std::size_t> all(run.keyframes.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return map_of_keyframes(run, all, config);
}

namespace {

void mark_cells(const std::vector<ChangedCell>& cells, CellState state, OccupancyMap& map) {
  const CellOffset offset = cells_from_origin(map.geometry);
  for (const ChangedCell& changed : cells) {
    const CellIndex cell = changed.cell + offset;
    if (!map.geometry.contains(cell)) continue;
    map.cells.set(static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(map.geometry.width) +
                      static_cast<std::size_t>(cell.x),
                  state);
  }
}

}  // namespace

std::vector<DriveStretch> split_drives(const DrivenKeyframes& run) {
  std::vector<std::size_t> starts{0};
  starts.insert(starts.end(), run.drives.begin(), run.drives.end());
  std::vector<DriveStretch> stretches;
  std::size_t keyframe = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const std::size_t end = i + 1 < starts.size() ? starts[i + 1] : run.trajectory.size();
    DriveStretch stretch{.first_keyframe = keyframe};
    while (keyframe < run.keyframes.size() && run.keyframes[keyframe].scan < end) ++keyframe;
    stretch.end_keyframe = keyframe;
    stretch.first_s = std::numeric_limits<double>::infinity();
    stretch.last_s = -stretch.first_s;
    for (std::size_t scan = starts[i]; scan < end; ++scan) {
      stretch.first_s = std::min(stretch.first_s, run.trajectory[scan].stamp_s);
      stretch.last_s = std::max(stretch.last_s, run.trajectory[scan].stamp_s);
    }
    stretches.push_back(stretch);
  }
  return stretches;
}

ViewCounts::Limits change_view_limits(const MapperConfig& config, const ChangeLimits& limits) {
  return {.rays = {.resolution_m = config.map.resolution_m,
                   .min_range_m = config.scan.min_range_m,
                   .max_range_m = config.scan.max_range_m,
                   .short_of_end_m = limits.tolerance_m},
          .spacing_m = limits.spacing_m,
          .max_cells = static_cast<std::uint64_t>(config.map.max_megacells) << 20U};
}

MapChanges changes_after_all(const DrivenKeyframes& run, const MapperConfig& config) {
  if (run.drives.empty()) return {};
  const ChangeLimits limits;
  std::vector<DriveViews> all;
  for (const DriveStretch& stretch : split_drives(run)) {
    all.push_back({ViewCounts(change_view_limits(config, limits)), stretch.first_s, stretch.last_s});
    for (std::size_t i = stretch.first_keyframe; i < stretch.end_keyframe; ++i) {
      all.back().views.add(run.keyframes[i].laser, run.keyframes[i].T_map_base);
    }
  }
  return SessionChanges(all, config.map.resolution_m, limits).last();
}

void mark_changes(const MapChanges& after_all, OccupancyMap& map) {
  mark_cells(after_all.gone, CellState::kFree, map);
  mark_cells(after_all.appeared, CellState::kOccupied, map);
}

CellOffset cells_from_origin(const GridGeometry& map) {
  const auto whole = [&map](double origin_m) {
    return static_cast<std::int32_t>(std::lround(origin_m / map.resolution_m));
  };
  return {-whole(map.origin_x_m), -whole(map.origin_y_m)};
}

}  // namespace gdtslam
