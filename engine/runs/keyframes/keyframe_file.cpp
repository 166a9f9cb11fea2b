#include "keyframe_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "engine/io/atomic_file.hpp"
#include "engine/io/binary/bytes.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/logs/gzip_file.hpp"
#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"

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

// Zero, or one more than the step from the last return, which is small beside most others.
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

// The smallest that there is: number, flags, stamp, pose, mount, five numbers of the laser, count of beams.
constexpr std::size_t kLeastKeyframeBytes = 4 + 1 + (1 + 3 + 3 + 5) * sizeof(double) + 4;

void read_start(BytesIn& in) {
  if (in.text(kMagic.size()) != kMagic) in.refuse("holds no keyframes of a run");
  if (const std::uint32_t version = in.whole(); version != kKeyframeVersion) {
    in.refuse(fmt::format("has version {}, and this program reads version {}", version, kKeyframeVersion));
  }
}

std::string digest_text(std::string_view bytes) { return Sha256().update(bytes).hex(); }

// All of the file, unpacked.
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
  BytesIn start(bytes, path);  // first: in another version the checksum may be another, too
  read_start(start);
  if (start.left() < kDigestDigits) start.refuse("ends within its header");
  const std::string_view body = std::string_view(bytes).substr(0, bytes.size() - kDigestDigits);
  if (bytes.compare(body.size(), kDigestDigits, digest_text(body)) != 0) {
    throw InputError({path, 0}, "is damaged: its checksum is that of other bytes");
  }
  return parse_keyframes(body, path);
}

}  // namespace gdtslam
