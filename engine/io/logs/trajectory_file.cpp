#include "gdtslam/io/trajectory_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/io/file_limits.hpp"
#include "engine/io/line_reader.hpp"
#include "field_cursor.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "tum_row.hpp"

namespace gdtslam {
namespace {

using Row = std::array<double, 8>;

/// Calls `take(values, position)`, which may keep them, for each row of eight finite numbers. Throws InputError with
/// file and line.
template <class Take>
void for_each_row(std::unique_ptr<ByteSource> source, const std::string& name, const char* columns, Take take) {
  constexpr std::size_t kMaxRowBytes = 4096;
  LineReader lines(gunzip_if_packed(std::move(source), name), kMaxRowBytes);
  std::uint64_t kept_bytes = 0;
  while (const std::optional<TextLine> line = lines.next()) {
    const FilePosition position{name, line->number};
    FieldCursor cursor(line->text);
    if (cursor.at_end() || line->text[line->text.find_first_not_of(" \t\r")] == '#') {
      continue;
    }
    Row values{};
    try {
      if (line->is_too_long) {
        throw MalformedLine("is too long");
      }
      for (double& value : values) {
        value = cursor.finite("numbers");
      }
      if (!cursor.at_end()) {
        throw MalformedLine("has more numbers than that");
      }
    } catch (const MalformedLine& error) {
      throw InputError(position, fmt::format("the row {}; a row is `{}`", error.what(), columns));
    }
    take(values, position);
    kept_bytes += sizeof(values);
    check_kept_bytes(kept_bytes, lines.source().bytes_from_file(), name);
  }
  if (const std::string defect = lines.source().defect(); !defect.empty()) {
    throw InputError({name, 0}, defect);
  }
}

// No two places on earth are farther apart; squares of the distance and their sums stay finite.
void check_place(double x_m, double y_m, const FilePosition& position) {
  constexpr double kFarthest_m = 1.0e9;
  if (std::fabs(x_m) <= kFarthest_m && std::fabs(y_m) <= kFarthest_m) return;
  throw InputError(position,
                   fmt::format("({:g}, {:g}) is no place: x and y are metres, {:g} at most", x_m, y_m, kFarthest_m));
}

// Allows a whole turn either way, and the rounding of its decimals.
void check_turn(double yaw_rad, const FilePosition& position) {
  constexpr double kMost_rad = kTwoPi + 0.001;
  if (std::fabs(yaw_rad) <= kMost_rad) return;
  throw InputError(position, fmt::format("the yaw of {:g} rad is more than a whole turn; is it in degrees? "
                                         "A row is `t1 t2 x y z roll pitch yaw` in metres and radians",
                                         yaw_rad));
}

/// Yaw of a quaternion of any length, also for rotations not about z.
double quaternion_yaw(double x, double y, double z, double w) {
  return atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z);
}

Trajectory read_tum(std::unique_ptr<ByteSource> source, const std::string& name) {
  Trajectory trajectory;
  for_each_row(std::move(source), name, "stamp x y z qx qy qz qw", [&](const Row& row, const FilePosition& position) {
    const auto [stamp_s, x_m, y_m, z_m, qx, qy, qz, qw] = row;
    const double sq_norm = qx * qx + qy * qy + qz * qz + qw * qw;
    constexpr double kTolerance = 0.01;
    if (std::fabs(sq_norm - 1.0) > kTolerance) {
      throw InputError(position, fmt::format("the quaternion has the squared length {}, not 1; "
                                             "a row is `stamp x y z qx qy qz qw`",
                                             sq_norm));
    }
    check_place(x_m, y_m, position);
    trajectory.push_back({stamp_s, {x_m, y_m, quaternion_yaw(qx, qy, qz, qw)}});
  });
  return trajectory;
}

}  // namespace

std::string tum_row(double stamp_s, const Pose3& T_map_base) {
  if (!T_map_base.is_finite() || !std::isfinite(stamp_s)) {
    throw Error(ExitCode::kFailed, fmt::format("the pose at {} s is not finite and cannot be written", stamp_s));
  }
  const Point3& at_m = T_map_base.translation_m;
  const Eigen::Quaterniond& q = T_map_base.rotation;
  return fmt::format("{:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", stamp_s, at_m.x(), at_m.y(), at_m.z(),
                     q.x(), q.y(), q.z(), q.w());
}

std::string tum_text(const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory) {
    const Pose2& T = pose.T_map_base;
    text += tum_row(pose.stamp_s, embed({T.x_m, T.y_m, wrap_angle(T.theta_rad)}));
  }
  return text;
}

void write_tum(const std::string& path, const Trajectory& trajectory) {
  write_file_atomically(path, tum_text(trajectory));
}

Trajectory read_tum(const std::string& path) { return read_tum(open_file_source(path), path); }

Trajectory read_tum(std::span<const std::byte> data, const std::string& name) {
  return read_tum(open_memory_source(data), name);
}

std::vector<Relation> read_relations(const std::string& path) {
  std::vector<Relation> relations;
  std::size_t unit_quaternions = 0;
  for_each_row(open_file_source(path), path, "t1 t2 x y z roll pitch yaw",
               [&](const Row& row, const FilePosition& position) {
                 const double square = row[4] * row[4] + row[5] * row[5] + row[6] * row[6] + row[7] * row[7];
                 if (std::abs(square - 1.0) < 1e-3) ++unit_quaternions;
                 check_place(row[2], row[3], position);
                 check_turn(row[7], position);
                 relations.push_back({row[0], row[1], {row[2], row[3], wrap_angle(row[7])}});
               });
  if (relations.empty()) throw InputError({path, 0}, "holds no relation; a row is `t1 t2 x y z roll pitch yaw`");
  // One relation may turn by 1 rad; several whose last four numbers all have length 1 are quaternions.
  if (relations.size() > 2 && unit_quaternions == relations.size()) {
    throw InputError({path, 0},
                     "is a trajectory with rows `t x y z qx qy qz qw` and no relations, `t1 t2 x y z roll pitch yaw`");
  }
  return relations;
}

}  // namespace gdtslam
