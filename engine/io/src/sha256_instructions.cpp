#include "sha256_blocks.hpp"

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace gdtslam {

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))

namespace {

#define GDTSLAM_SHA __attribute__((target("sha,ssse3,sse4.1")))

/// The state as the instructions want it: words A B E F and C D G H, the first in the highest place.
struct ShaState {
  __m128i abef;
  __m128i cdgh;
};

GDTSLAM_SHA __m128i load(const void* from) { return _mm_loadu_si128(static_cast<const __m128i*>(from)); }

GDTSLAM_SHA ShaState packed(const Sha256State& state) {
  const __m128i badc = _mm_shuffle_epi32(load(state.data()), 0xb1);
  const __m128i hgfe = _mm_shuffle_epi32(load(state.data() + 4), 0x1b);
  return {_mm_alignr_epi8(badc, hgfe, 8), _mm_blend_epi16(hgfe, badc, 0xf0)};
}

GDTSLAM_SHA void unpack(const ShaState& from, Sha256State& state) {
  const __m128i feba = _mm_shuffle_epi32(from.abef, 0x1b);
  const __m128i dchg = _mm_shuffle_epi32(from.cdgh, 0xb1);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data()), _mm_blend_epi16(feba, dchg, 0xf0));
  _mm_storeu_si128(reinterpret_cast<__m128i*>(state.data() + 4), _mm_alignr_epi8(dchg, feba, 8));
}

// Four words of the schedule from the sixteen before them, the oldest first.
GDTSLAM_SHA __m128i next_words(__m128i w0, __m128i w1, __m128i w2, __m128i w3) {
  const __m128i sum = _mm_add_epi32(_mm_sha256msg1_epu32(w0, w1), _mm_alignr_epi8(w3, w2, 4));
  return _mm_sha256msg2_epu32(sum, w3);
}

GDTSLAM_SHA void four_rounds(ShaState& state, __m128i words, std::size_t round) {
  const __m128i sum = _mm_add_epi32(words, load(kSha256RoundConstants.data() + round));
  state.cdgh = _mm_sha256rnds2_epu32(state.cdgh, state.abef, sum);
  state.abef = _mm_sha256rnds2_epu32(state.abef, state.cdgh, _mm_shuffle_epi32(sum, 0x0e));
}

GDTSLAM_SHA void process(ShaState& state, const std::uint8_t* block) {
  const __m128i big_endian = _mm_set_epi64x(0x0c0d0e0f08090a0bLL, 0x0405060700010203LL);
  const ShaState before = state;
  __m128i w0 = _mm_shuffle_epi8(load(block), big_endian);
  __m128i w1 = _mm_shuffle_epi8(load(block + 16), big_endian);
  __m128i w2 = _mm_shuffle_epi8(load(block + 32), big_endian);
  __m128i w3 = _mm_shuffle_epi8(load(block + 48), big_endian);
  for (std::size_t round = 0;; round += 16) {
    four_rounds(state, w0, round);
    four_rounds(state, w1, round + 4);
    four_rounds(state, w2, round + 8);
    four_rounds(state, w3, round + 12);
    if (round == 48) break;
    w0 = next_words(w0, w1, w2, w3);
    w1 = next_words(w1, w2, w3, w0);
    w2 = next_words(w2, w3, w0, w1);
    w3 = next_words(w3, w0, w1, w2);
  }
  state.abef = _mm_add_epi32(state.abef, before.abef);
  state.cdgh = _mm_add_epi32(state.cdgh, before.cdgh);
}

}  // namespace

bool has_sha_instructions() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  constexpr unsigned kSha = 1U << 29U;
  if (__get_cpuid_count(7, 0, &a, &b, &c, &d) == 0 || (b & kSha) == 0) return false;
  return __builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("ssse3");
}

GDTSLAM_SHA void process_with_instructions(Sha256State& state, const std::uint8_t* blocks, std::size_t count) {
  constexpr std::size_t kBlockBytes = 64;
  ShaState words = packed(state);
  for (std::size_t k = 0; k < count; ++k) process(words, blocks + k * kBlockBytes);
  unpack(words, state);
}

#undef GDTSLAM_SHA

#else

bool has_sha_instructions() { return false; }
void process_with_instructions(Sha256State& /*state*/, const std::uint8_t* /*blocks*/, std::size_t /*count*/) {}

#endif

}  // namespace gdtslam
