// Scores of poses in a map of normal distributions (ndt_cost.hpp). Blocks of points are moved by all poses in turn, in
// loops that become vectors; the distributions are looked up one after the other.

constexpr std::uint32_t kNdtBlock = 128;
constexpr std::uint32_t kNoCube = 0xFFFFFFFFU;
constexpr std::uint32_t kDistributionWords = sizeof(NdtCost::Distribution) / sizeof(std::uint32_t);
constexpr std::uint32_t kDistributionValues = 9;  // the others are unused

/// A block of the cloud's points.
struct NdtPoints {
  alignas(64) float x[kNdtBlock];
  alignas(64) float y[kNdtBlock];
  alignas(64) float z[kNdtBlock];
};

/// The points in the frame of the box.
struct NdtPlaces {
  NdtPoints at;
  alignas(64) std::uint32_t cube[kNdtBlock];  ///< or kNoCube
};

inline void load_ndt_points(const NdtCost::Point* from, std::uint32_t count, NdtPoints& points) {
  for (std::uint32_t i = 0; i < count; ++i) {
    points.x[i] = from[i].x;
    points.y[i] = from[i].y;
    points.z[i] = from[i].z;
  }
}

/// Coordinates and cubes along an axis; a point whose cube is not below the size is not in the box.
inline void place_along(const float* row, float shift, float cubes_per_m, const NdtPoints& points, std::uint32_t count,
                        float* place, std::uint32_t* cube) {
  const float row_x = row[0];
  const float row_y = row[1];
  const float row_z = row[2];
  for (std::uint32_t i = 0; i < count; ++i) {
    const float at = ((row_x * points.x[i] + row_y * points.y[i]) + row_z * points.z[i]) + shift;
    const float counted = at * cubes_per_m + 1.0F;
    const float above = counted > 0.0F ? counted : 0.0F;
    const float within = above < 1073741824.0F ? above : 1073741824.0F;
    place[i] = at;
    cube[i] = static_cast<std::uint32_t>(static_cast<std::int32_t>(within)) - 1U;
  }
}

inline void place_ndt_points(const NdtCost::Params& params, const NdtCost::Pose& pose, const NdtPoints& points,
                             std::uint32_t count, NdtPlaces& places) {
  alignas(64) std::uint32_t cubes[3][kNdtBlock];
  const float* const shift = pose.translation_m;
  const float* const row = pose.rotation;
  const float per_m = params.cubes_per_m;
  place_along(row, shift[0] - params.origin_x_m, per_m, points, count, places.at.x, cubes[0]);
  place_along(row + 3, shift[1] - params.origin_y_m, per_m, points, count, places.at.y, cubes[1]);
  place_along(row + 6, shift[2] - params.origin_z_m, per_m, points, count, places.at.z, cubes[2]);
  const std::uint32_t size_x = params.size_x;
  const std::uint32_t size_y = params.size_y;
  const std::uint32_t size_z = params.size_z;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t number = (cubes[2][i] * size_y + cubes[1][i]) * size_x + cubes[0][i];
    const std::uint32_t in_x = cubes[0][i] < size_x ? number : kNoCube;
    const std::uint32_t in_y = cubes[1][i] < size_y ? in_x : kNoCube;
    places.cube[i] = cubes[2][i] < size_z ? in_y : kNoCube;
  }
}

/// Points that are in cubes with distributions, in the frame of the box, and these distributions.
struct NdtHits {
  NdtPoints at;
  alignas(64) float normal[kDistributionValues][kNdtBlock];  ///< mean x, y, z, then xx, xy, xz, yy, yz, zz
};

/// The block's points that hit a distribution; returns their number.
inline std::uint32_t find_ndt_hits(const NdtCost::Params& params, const std::uint32_t* distributions,
                                   const NdtPlaces& places, std::uint32_t count, NdtHits& hits) {
  const std::uint32_t* const cubes = distributions + std::size_t{kDistributionWords} * params.distribution_count;
  std::uint32_t inside[kNdtBlock];
  std::uint32_t inside_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    inside[inside_count] = i;
    inside_count += places.cube[i] != kNoCube ? 1 : 0;
  }
  std::uint32_t found[kNdtBlock];
  std::uint32_t hit_count = 0;
  for (std::uint32_t k = 0; k < inside_count; ++k) {
    const std::uint32_t i = inside[k];
    inside[hit_count] = i;
    found[hit_count] = cubes[places.cube[i]];
    hit_count += found[hit_count] < params.distribution_count ? 1 : 0;
  }
  for (std::uint32_t k = 0; k < hit_count; ++k) {
    const std::uint32_t* const words = distributions + std::size_t{kDistributionWords} * found[k];
    const std::uint32_t i = inside[k];
    hits.at.x[k] = places.at.x[i];
    hits.at.y[k] = places.at.y[i];
    hits.at.z[k] = places.at.z[i];
    for (std::uint32_t v = 0; v < kDistributionValues; ++v) {
      hits.normal[v][k] = __builtin_bit_cast(float, words[v]);
    }
  }
  return hit_count;
}

inline std::uint32_t ndt_score(const NdtHits& hits, std::uint32_t count, float steps_per_unit,
                               const std::uint32_t* table) {
  alignas(64) std::int32_t step[kNdtBlock];
  const auto& n = hits.normal;
  for (std::uint32_t k = 0; k < count; ++k) {
    const float dx = hits.at.x[k] - n[0][k];
    const float dy = hits.at.y[k] - n[1][k];
    const float dz = hits.at.z[k] - n[2][k];
    const float a = n[4][k] * dy + n[5][k] * dz;
    const float b = n[7][k] * dz;
    const float u = n[3][k] * dx + (a + a);
    const float v = n[6][k] * dy + (b + b);
    const float q = (u * dx + v * dy) + (n[8][k] * dz) * dz;
    const float steps = q * steps_per_unit;
    const float below = steps < 255.0F ? steps : 255.0F;
    step[k] = static_cast<std::int32_t>(below > 0.0F ? below : 0.0F);
  }
  std::uint32_t sum = 0;
  for (std::uint32_t k = 0; k < count; ++k) sum += table[step[k]];
  return sum;
}

void ndt_cost(const NdtCost::Params& params, const std::uint32_t* map, const NdtCost::Point* points,
              const NdtCost::Pose* poses, std::uint32_t* scores, Slice slice) {
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) scores[i] = 0;
  NdtPoints block;
  NdtPlaces places;
  NdtHits hits;
  for (std::uint32_t first = 0; first < params.point_count; first += kNdtBlock) {
    const std::uint32_t count = lesser(kNdtBlock, params.point_count - first);
    load_ndt_points(points + first, count, block);
    for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
      place_ndt_points(params, poses[i], block, count, places);
      const std::uint32_t hit_count = find_ndt_hits(params, map + NdtCost::kSteps, places, count, hits);
      scores[i] += ndt_score(hits, hit_count, params.steps_per_unit, map);
    }
  }
}
