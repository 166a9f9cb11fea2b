// Oracles of single dispatches: what a case of the list must leave behind.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "brute_bounds.hpp"
#include "brute_force.hpp"
#include "brute_lines.hpp"
#include "brute_ndt.hpp"
#include "brute_slope.hpp"
#include "brute_sweep.hpp"
#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/gdt_stamp/gdt_stamp.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"

namespace gdtslam::test {
namespace {

template <class T>
std::vector<T> values_of(const std::vector<std::byte>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) {
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  }
  return values;
}

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  if (!values.empty()) {
    std::memcpy(bytes.data(), values.data(), bytes.size());
  }
  return bytes;
}

template <class Params>
Params params_of(const KernelCase& kernel_case) {
  Params params;
  std::memcpy(&params, kernel_case.params.data(), sizeof(params));
  return params;
}

/// Sets every cell of a grid in buffer `binding` to value(x, y).
template <class T, class Value>
void fill(const KernelCase& kernel_case, CaseOutcome& outcome, std::size_t binding, Value value) {
  const ValueLayout& layout = kernel_case.buffers[binding].layout;
  std::vector<T> values = values_of<T>(outcome.contents[binding]);
  for (std::uint32_t y = 0; y < layout.height; ++y) {
    for (std::uint32_t x = 0; x < layout.width; ++x) {
      values[std::size_t{y} * layout.stride + x] = static_cast<T>(value(x, y));
    }
  }
  outcome.contents[binding] = bytes_of(values);
}

std::int64_t sq_to(std::uint32_t packed, std::int64_t x, std::int64_t y) {
  const std::int64_t dx = packed % 65536 - x;
  const std::int64_t dy = packed / 65536 - y;
  return dx * dx + dy * dy;
}

void flood_init_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<JumpFloodInit::Params>(kernel_case);
  const auto seeds = values_of<std::uint8_t>(outcome.contents[0]);
  fill<std::uint32_t>(kernel_case, outcome, 1, [&](std::uint32_t x, std::uint32_t y) {
    return seeds[std::size_t{y} * params.stride + x] != 0 ? y * 65536 + x : kNoSeed;
  });
}

void flood_step_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<JumpFloodStep::Params>(kernel_case);
  const auto before = values_of<std::uint32_t>(outcome.contents[0]);
  fill<std::uint32_t>(kernel_case, outcome, 1, [&](std::int64_t x, std::int64_t y) {
    std::map<std::pair<std::int64_t, std::uint32_t>, std::uint32_t> ranked;
    for (std::int64_t dy = -1; dy <= 1; ++dy) {
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        const std::int64_t nx = x + dx * params.step;
        const std::int64_t ny = y + dy * params.step;
        if (nx < 0 || ny < 0 || nx >= params.width || ny >= params.height) {
          continue;
        }
        const std::uint32_t seed = before[static_cast<std::size_t>(ny * params.stride + nx)];
        if (seed != kNoSeed) {
          ranked[{sq_to(seed, x, y), seed}] = seed;
        }
      }
    }
    return ranked.empty() ? kNoSeed : ranked.begin()->second;
  });
}

void flood_distance_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<JumpFloodDistance::Params>(kernel_case);
  const auto nearest = values_of<std::uint32_t>(outcome.contents[0]);
  const std::int64_t most = std::int64_t{params.radius} * params.radius;
  fill<std::uint16_t>(kernel_case, outcome, 1, [&](std::int64_t x, std::int64_t y) {
    const std::uint32_t seed = nearest[static_cast<std::size_t>(y * params.stride + x)];
    return seed == kNoSeed ? most : std::min(sq_to(seed, x, y), most);
  });
}

void field_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<DistanceField::Params>(kernel_case);
  const auto squares = values_of<std::uint16_t>(outcome.contents[0]);
  const auto table = values_of<std::uint16_t>(outcome.contents[1]);
  fill<std::uint16_t>(kernel_case, outcome, 2, [&](std::uint32_t x, std::uint32_t y) {
    const std::size_t sq = squares[std::size_t{y} * params.stride + x];
    return sq < table.size() ? table[sq] : table.back();
  });
}

void cost_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<PoseCost::Params>(kernel_case);
  const auto field = values_of<std::uint16_t>(outcome.contents[0]);
  const auto points = values_of<PointCells>(outcome.contents[1]);
  const auto poses = values_of<PoseCandidate>(outcome.contents[2]);
  fill<std::uint32_t>(kernel_case, outcome, 3,
                      [&](std::uint32_t i, std::uint32_t) { return brute_pose_cost(params, field, points, poses[i]); });
}

/// Writes a cell, and where it is the first of a strip's row behind the 64 of the strip before too.
void put_cell(std::vector<std::uint16_t>& field, std::size_t place, std::uint16_t cell, std::size_t column,
              std::size_t strip) {
  field[place] = cell;
  if (strip != 64 && column > 0 && column % 64 == 0) field[place - strip + 64] = cell;
}

void merge_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<GdtMerge::Params>(kernel_case);
  auto global = values_of<std::uint16_t>(outcome.contents[0]);
  const auto scan = values_of<std::uint16_t>(outcome.contents[1]);
  for (std::size_t y = 0; y < params.scan_height; ++y) {
    for (std::size_t x = 0; x < params.scan_width; ++x) {
      const std::size_t column = x + params.offset_x;
      const std::size_t place =
          (y + params.offset_y) * params.global_stride + column / 64 * params.global_strip + column % 64;
      const auto value = static_cast<std::uint16_t>(global[place] ^ params.blank);
      const std::uint16_t merged = brute_merge(params, value, scan[y * params.scan_stride + x]);
      put_cell(global, place, static_cast<std::uint16_t>(merged ^ params.blank), column, params.global_strip);
    }
  }
  outcome.contents[0] = bytes_of(global);
}

/// Each cell by all obstacles of its tile, with the square root of the standard library.
void stamp_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<GdtStamp::Params>(kernel_case);
  const GdtMerge::Params rule{
      .threshold = params.threshold, .lift = params.lift, .cap = params.cap, .rule = params.rule};
  auto field = values_of<std::uint16_t>(outcome.contents[0]);
  const auto list = values_of<std::uint32_t>(outcome.contents[1]);
  for (std::size_t t = 0; t < 4 * std::size_t{params.tile_count}; t += 4) {
    const std::set<std::uint32_t> own(list.begin() + list[t + 2], list.begin() + list[t + 2] + list[t + 3]);
    for (std::int64_t y = 0; y < list[t + 1] / 65536; ++y) {
      for (std::int64_t x = 0; x < list[t + 1] % 65536; ++x) {
        double nearest = params.radius;
        for (const std::uint32_t at : own) {
          nearest = std::min(nearest, std::hypot(x + params.radius - at % 65536, y + params.radius - at / 65536));
        }
        const std::size_t place = list[t] + static_cast<std::size_t>(y) * params.stride + static_cast<std::size_t>(x);
        const auto value = static_cast<std::uint16_t>(field[place] ^ params.blank);
        const std::uint16_t merged = brute_merge(rule, value, static_cast<std::uint16_t>(std::lround(nearest * 256.0)));
        const std::size_t column = list[t] / params.strip * 64 + static_cast<std::size_t>(x);  // of fields in strips
        put_cell(field, place, static_cast<std::uint16_t>(merged ^ params.blank), column, params.strip);
      }
    }
  }
  outcome.contents[0] = bytes_of(field);
}

void scatter_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto cells = values_of<std::uint32_t>(outcome.contents[0]);
  const std::set<std::uint32_t> named(cells.begin(), cells.end());
  const auto before = values_of<std::uint8_t>(outcome.contents[1]);
  const std::size_t stride = params_of<SeedScatter::Params>(kernel_case).stride;
  fill<std::uint8_t>(kernel_case, outcome, 1, [&](std::uint32_t x, std::uint32_t y) {
    return named.contains(y * 65536 + x) ? std::uint8_t{1} : before[y * stride + x];
  });
}

void grow_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<FieldGrow::Params>(kernel_case);
  const auto old_field = values_of<std::uint16_t>(outcome.contents[0]);
  fill<std::uint16_t>(kernel_case, outcome, 1, [&](std::int64_t x, std::int64_t y) {
    const std::int64_t old_x = x - params.offset_x;
    const std::int64_t old_y = y - params.offset_y;
    const bool known = old_x >= 0 && old_y >= 0 && old_x < params.old_width && old_y < params.old_height;
    return known ? old_field[static_cast<std::size_t>(old_y * params.old_stride + old_x)] : params.cap;
  });
}

void descent_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<PoseDescent::Params>(kernel_case);
  const auto field = values_of<std::uint16_t>(outcome.contents[0]);
  const auto points = values_of<PointCells>(outcome.contents[1]);
  auto poses = values_of<PolishedPose>(outcome.contents[2]);
  std::vector<std::uint16_t> values;
  for (PolishedPose& pose : poses) {
    pose = brute_slope_descent(params, field, points, pose);
    const std::vector<std::uint16_t> row = brute_point_values(params.grid, field, points, {pose.x, pose.y, pose.theta});
    values.insert(values.end(), row.begin(), row.end());
    if (points.size() % 2 != 0) values.push_back(0);
  }
  outcome.contents[2] = bytes_of(poses);
  outcome.contents[3] = bytes_of(values);
}

void lines_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<PointToLine::Params>(kernel_case);
  const auto values = values_of<float>(outcome.contents[0]);
  const auto bins = values_of<std::uint16_t>(outcome.contents[1]);
  std::vector<PointToLine::Sums> sums;
  for (const PointToLine::Pair& pair : values_of<PointToLine::Pair>(outcome.contents[2])) {
    sums.push_back(brute_line_sums(params, values, bins, pair));
  }
  outcome.contents[3] = bytes_of(sums);
}

void ndt_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<NdtCost::Params>(kernel_case);
  const auto map = values_of<std::uint32_t>(outcome.contents[0]);
  const auto points = values_of<NdtCost::Point>(outcome.contents[1]);
  const auto poses = values_of<NdtCost::Pose>(outcome.contents[2]);
  fill<std::uint32_t>(kernel_case, outcome, 3,
                      [&](std::uint32_t i, std::uint32_t) { return brute_ndt_score(params, map, points, poses[i]); });
}

void sweep_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const SweepInput input{.params = params_of<SweepPoints::Params>(kernel_case),
                         .beams = values_of<BeamRange>(outcome.contents[0]),
                         .strips = values_of<BeamStrip>(outcome.contents[1]),
                         .tables = values_of<float>(outcome.contents[2])};
  std::vector<SweptPoint> points(input.beams.size());
  for (std::uint32_t beam = 0; beam < points.size(); ++beam) {
    points[beam] = brute_sweep_point(input, beam);
  }
  outcome.contents[3] = bytes_of(points);
}

void bounds_oracle(const KernelCase& kernel_case, CaseOutcome& outcome) {
  const auto params = params_of<PoseBounds::Params>(kernel_case);
  const auto field = values_of<std::uint8_t>(outcome.contents[0]);
  const auto points = values_of<BoundPoint>(outcome.contents[1]);
  std::vector<std::uint32_t> sums;
  for (const PoseCandidate& tile : values_of<PoseCandidate>(outcome.contents[2])) {
    const std::vector<std::uint32_t> boxes = brute_bounds(params, field, points, tile);
    sums.insert(sums.end(), boxes.begin(), boxes.end());
  }
  outcome.contents[3] = bytes_of(sums);
}

using Oracle = std::function<void(const KernelCase&, CaseOutcome&)>;

const std::map<std::string_view, Oracle>& oracles() {
  static const std::map<std::string_view, Oracle> table{{"jump_flood_init", flood_init_oracle},
                                                        {"jump_flood_step", flood_step_oracle},
                                                        {"jump_flood_distance", flood_distance_oracle},
                                                        {"distance_field", field_oracle},
                                                        {"pose_cost", cost_oracle},
                                                        {"gdt_merge", merge_oracle},
                                                        {"seed_scatter", scatter_oracle},
                                                        {"field_grow", grow_oracle},
                                                        {"pose_descent", descent_oracle},
                                                        {"sweep_points", sweep_oracle},
                                                        {"pose_bounds", bounds_oracle},
                                                        {"gdt_stamp", stamp_oracle},
                                                        {"point_to_line", lines_oracle},
                                                        {"ndt_cost", ndt_oracle}};
  return table;
}

}  // namespace

CaseOutcome brute_outcome(const KernelCase& kernel_case) {
  const auto oracle = oracles().find(kernel_case.kernel->name);
  if (oracle == oracles().end()) {
    throw std::logic_error("no oracle for kernel " + std::string(kernel_case.kernel->name));
  }
  CaseOutcome outcome;
  for (const CaseBuffer& buffer : kernel_case.buffers) {
    outcome.contents.push_back(buffer.content);
  }
  oracle->second(kernel_case, outcome);
  return outcome;
}

}  // namespace gdtslam::test
