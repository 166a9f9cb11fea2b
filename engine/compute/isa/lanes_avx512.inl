// Sixteen lanes: AVX-512.

constexpr std::uint32_t kLanes = 16;
using Floats = __m512;
using Ints = __m512i;

inline Floats all(float value) { return _mm512_set1_ps(value); }
inline Ints all(std::int32_t value) { return _mm512_set1_epi32(value); }
inline Floats add(Floats a, Floats b) { return _mm512_add_ps(a, b); }
inline Floats sub(Floats a, Floats b) { return _mm512_sub_ps(a, b); }
inline Floats mul(Floats a, Floats b) { return _mm512_mul_ps(a, b); }
/// a > b ? a : b, and a < b ? a : b: b when a is NaN.
inline Floats greater(Floats a, Floats b) { return _mm512_max_ps(a, b); }
inline Floats lesser(Floats a, Floats b) { return _mm512_min_ps(a, b); }
inline Ints floor_to_int(Floats a) { return _mm512_cvt_roundps_epi32(a, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC); }
inline Ints add(Ints a, Ints b) { return _mm512_add_epi32(a, b); }
inline Ints sub(Ints a, Ints b) { return _mm512_sub_epi32(a, b); }
inline Ints mul(Ints a, Ints b) { return _mm512_mullo_epi32(a, b); }
inline Ints greater(Ints a, Ints b) { return _mm512_max_epi32(a, b); }
inline Ints lesser(Ints a, Ints b) { return _mm512_min_epi32(a, b); }
inline Ints both(Ints a, Ints b) { return _mm512_and_si512(a, b); }
inline Ints either(Ints a, Ints b) { return _mm512_xor_si512(a, b); }
/// Sum of the products of the signed 16-bit halves.
inline Ints dot_halves(Ints a, Ints b) { return _mm512_madd_epi16(a, b); }
template <int kBits>
Ints shift_left(Ints a) {
  return _mm512_slli_epi32(a, kBits);
}
template <int kBits>
Ints shift_right_signed(Ints a) {
  return _mm512_srai_epi32(a, kBits);
}
inline Ints shift_right(Ints a, __m128i bits) { return _mm512_srl_epi32(a, bits); }
inline Ints load(const void* aligned) { return _mm512_load_si512(aligned); }
inline void store(void* aligned, Ints a) { _mm512_store_si512(aligned, a); }
/// Masked broadcasts, because few units insert into vectors.
inline __m128i load_four_pairs(const std::uint16_t* field, const std::uint32_t* cells) {
  const __m128i one = _mm_loadu_si32(field + cells[0]);
  const __m128i two = _mm_mask_broadcastd_epi32(one, 2, _mm_loadu_si32(field + cells[1]));
  const __m128i three = _mm_mask_broadcastd_epi32(two, 4, _mm_loadu_si32(field + cells[2]));
  return _mm_mask_broadcastd_epi32(three, 8, _mm_loadu_si32(field + cells[3]));
}
/// Cells and, in the upper halves, their right neighbours. Single loads beat gather instructions.
inline Ints load_pairs(const std::uint16_t* field, const std::uint32_t* cells) {
  const __m256i low = _mm256_set_m128i(load_four_pairs(field, cells + 4), load_four_pairs(field, cells));
  const __m256i high = _mm256_set_m128i(load_four_pairs(field, cells + 12), load_four_pairs(field, cells + 8));
  return _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}
/// Cells of a row, or pairs as of load_pairs, by column modulo 64: columns 0 to 31 are in `low`, the others in `high`.
template <bool kPairs>
Ints pick_cells(const std::uint16_t* low, const std::uint16_t* high, Ints columns) {
  const Ints twice = _mm512_shuffle_epi8(columns, _mm512_set4_epi32(0x0C0C0C0C, 0x08080808, 0x04040404, 0));
  const Ints picked = kPairs ? add(twice, all(1 << 16)) : columns;
  return _mm512_permutex2var_epi16(_mm512_loadu_si512(low), picked, _mm512_loadu_si512(high));
}
inline std::uint32_t lane_sum(Ints a) {
  const __m256i eight = _mm256_add_epi32(_mm512_castsi512_si256(a), _mm512_extracti64x4_epi64(a, 1));
  const __m128i four = _mm_add_epi32(_mm256_castsi256_si128(eight), _mm256_extracti128_si256(eight, 1));
  const __m128i two = _mm_add_epi32(four, _mm_shuffle_epi32(four, 0x4E));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_add_epi32(two, _mm_shuffle_epi32(two, 0xB1))));
}
inline Floats load_floats(const float* values) { return _mm512_loadu_ps(values); }
inline Ints bits_of(Floats a) { return _mm512_castps_si512(a); }
inline Ints lane_numbers() { return _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15); }
/// The least of the lanes, none of which is negative.
inline std::uint32_t lane_least(Ints a) {
  const __m256i eight = _mm256_min_epi32(_mm512_castsi512_si256(a), _mm512_extracti64x4_epi64(a, 1));
  const __m128i four = _mm_min_epi32(_mm256_castsi256_si128(eight), _mm256_extracti128_si256(eight, 1));
  const __m128i two = _mm_min_epi32(four, _mm_shuffle_epi32(four, 0x4E));
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_min_epi32(two, _mm_shuffle_epi32(two, 0xB1))));
}

struct LanePoints {
  Floats x;
  Floats y;
};
inline LanePoints split(Floats low, Floats high) {
  const Ints even = add(lane_numbers(), lane_numbers());
  return {_mm512_permutex2var_ps(low, even, high), _mm512_permutex2var_ps(low, add(even, all(1)), high)};
}
inline LanePoints load_points(const PointCells* points) {
  return split(_mm512_loadu_ps(&points->x), _mm512_loadu_ps(&points->x + 16));
}
/// The first `count` < 16 points; later ones are not read and become zero.
inline LanePoints load_points(const PointCells* points, std::uint32_t count) {
  const std::uint32_t mask = (1U << 2 * count) - 1U;
  return split(_mm512_maskz_loadu_ps(static_cast<__mmask16>(mask & 0xFFFFU), &points->x),
               _mm512_maskz_loadu_ps(static_cast<__mmask16>(mask >> 16U), &points->x + 16));
}
/// The lanes of the first `count` < 16 points, zero in the others.
inline Ints only_first(Ints a, std::uint32_t count) {
  return _mm512_maskz_mov_epi32(_mm512_cmplt_epi32_mask(lane_numbers(), all(static_cast<std::int32_t>(count))), a);
}
