// Eight lanes: AVX2.

constexpr std::uint32_t kLanes = 8;
using Floats = __m256;
using Ints = __m256i;

inline Floats all(float value) { return _mm256_set1_ps(value); }
inline Ints all(std::int32_t value) { return _mm256_set1_epi32(value); }
inline Floats add(Floats a, Floats b) { return _mm256_add_ps(a, b); }
inline Floats sub(Floats a, Floats b) { return _mm256_sub_ps(a, b); }
inline Floats mul(Floats a, Floats b) { return _mm256_mul_ps(a, b); }
/// a > b ? a : b, and a < b ? a : b: b when a is NaN.
inline Floats greater(Floats a, Floats b) { return _mm256_max_ps(a, b); }
inline Floats lesser(Floats a, Floats b) { return _mm256_min_ps(a, b); }
inline Ints floor_to_int(Floats a) { return _mm256_cvttps_epi32(_mm256_floor_ps(a)); }
inline Ints add(Ints a, Ints b) { return _mm256_add_epi32(a, b); }
inline Ints sub(Ints a, Ints b) { return _mm256_sub_epi32(a, b); }
inline Ints mul(Ints a, Ints b) { return _mm256_mullo_epi32(a, b); }
inline Ints greater(Ints a, Ints b) { return _mm256_max_epi32(a, b); }
inline Ints lesser(Ints a, Ints b) { return _mm256_min_epi32(a, b); }
inline Ints both(Ints a, Ints b) { return _mm256_and_si256(a, b); }
inline Ints either(Ints a, Ints b) { return _mm256_xor_si256(a, b); }
/// Sum of the products of the signed 16-bit halves.
inline Ints dot_halves(Ints a, Ints b) { return _mm256_madd_epi16(a, b); }
template <int kBits>
Ints shift_left(Ints a) {
  return _mm256_slli_epi32(a, kBits);
}
template <int kBits>
Ints shift_right_signed(Ints a) {
  return _mm256_srai_epi32(a, kBits);
}
inline Ints shift_right(Ints a, __m128i bits) { return _mm256_srl_epi32(a, bits); }
inline Ints load(const void* aligned) { return _mm256_load_si256(static_cast<const __m256i*>(aligned)); }
inline void store(void* aligned, Ints a) { _mm256_store_si256(static_cast<__m256i*>(aligned), a); }
/// Cells and, in the upper halves, their right neighbours. Single loads beat gather instructions.
inline Ints load_pairs(const std::uint16_t* field, const std::uint32_t* cells) {
  const auto pair = [=](std::uint32_t lane) { return _mm_cvtsi128_si32(_mm_loadu_si32(field + cells[lane])); };
  return _mm256_setr_epi32(pair(0), pair(1), pair(2), pair(3), pair(4), pair(5), pair(6), pair(7));
}
inline std::uint32_t lane_sum(Ints a) {
  const __m128i four = _mm_add_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
  const __m128i two = _mm_add_epi32(four, _mm_shuffle_epi32(four, 0x4E));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_add_epi32(two, _mm_shuffle_epi32(two, 0xB1))));
}
inline Floats load_floats(const float* values) { return _mm256_loadu_ps(values); }
inline Ints bits_of(Floats a) { return _mm256_castps_si256(a); }
inline Ints lane_numbers() { return _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7); }
/// The least of the lanes, none of which is negative.
inline std::uint32_t lane_least(Ints a) {
  const __m128i four = _mm_min_epi32(_mm256_castsi256_si128(a), _mm256_extracti128_si256(a, 1));
  const __m128i two = _mm_min_epi32(four, _mm_shuffle_epi32(four, 0x4E));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_min_epi32(two, _mm_shuffle_epi32(two, 0xB1))));
}

/// Points of the lanes. A lane's point is fixed; lanes are not in the order of the points, on which sums do not depend.
struct LanePoints {
  Floats x;
  Floats y;
};
inline LanePoints split(Floats low, Floats high) {
  return {_mm256_shuffle_ps(low, high, 0x88), _mm256_shuffle_ps(low, high, 0xDD)};
}
inline LanePoints load_points(const PointCells* points) {
  return split(_mm256_loadu_ps(&points->x), _mm256_loadu_ps(&points->x + 8));
}
/// The first `count` < 8 points; later ones are not read and become zero.
inline LanePoints load_points(const PointCells* points, std::uint32_t count) {
  const Ints point_of_value = _mm256_setr_epi32(0, 0, 1, 1, 2, 2, 3, 3);
  const Ints limit = all(static_cast<std::int32_t>(count));
  return split(_mm256_maskload_ps(&points->x, _mm256_cmpgt_epi32(limit, point_of_value)),
               _mm256_maskload_ps(&points->x + 8, _mm256_cmpgt_epi32(limit, add(point_of_value, all(4)))));
}
/// The lanes of the first `count` < 8 points, zero in the others.
inline Ints only_first(Ints a, std::uint32_t count) {
  const Ints point_of_lane = _mm256_setr_epi32(0, 1, 4, 5, 2, 3, 6, 7);
  return both(a, _mm256_cmpgt_epi32(all(static_cast<std::int32_t>(count)), point_of_lane));
}
