// Sine and cosine in single precision, the same bits in C++ and in every shader (docs/numerics.md).
//
// This file is valid GLSL 450 and, behind the prelude of engine/core/elementary.cpp, valid C++. Only additions,
// multiplications and integer operations, all of them `precise`: no contraction, no reordering. Radians.
// At most 1 ulp off for |angle| <= 64; the error grows with the angle beyond. Numbers: make_elementary_tables.py --float.
#ifndef GDTSLAM_ELEMENTARY_GLSL
#define GDTSLAM_ELEMENTARY_GLSL

struct SinCosF32 {
  float sin_value;
  float cos_value;
};

SinCosF32 sin_cos_f32(float angle_rad) {
  // Adding 1.5 * 2^23 leaves the nearest whole number of quarter turns in the low bits.
  precise float shifted = angle_rad * 0.636619747f + 12582912.0f;
  int quadrant = floatBitsToInt(shifted);
  precise float turns = shifted - 12582912.0f;

  // angle - turns * pi/2 = r - excess in three parts; the first two products are exact, and `excess` begins with what the
  // second difference rounds off. It is subtracted, for -0 - (+0) keeps the sign of an angle of -0.
  precise float first = angle_rad - turns * 1.57077026f;
  precise float second_part = turns * 2.60630623e-05f;
  precise float r = first - second_part;
  precise float excess = (second_part - (first - r)) + turns * 6.07710063e-11f;

  precise float t = r * r;
  precise float s_poly = (-0.000195186047f * t + 0.00833219104f) * t - 0.166666552f;
  precise float c_poly = (2.44306702e-05f * t - 0.00138873013f) * t + 0.0416666456f;
  precise float half_t = 0.5f * t;
  precise float c_head = 1.0f - half_t;
  precise float c_lost = (1.0f - c_head) - half_t;
  precise float s = r - (excess - (r * t) * s_poly);
  precise float c = c_head + (c_lost + ((t * t) * c_poly + r * excess));

  // Odd quarter turns exchange the two, quarter turns 2 and 3 (for the cosine 1 and 2) change the sign; by bits, so that
  // nothing branches.
  int s_bits = floatBitsToInt(s);
  int c_bits = floatBitsToInt(c);
  int exchange = (s_bits ^ c_bits) & -(quadrant & 1);
  SinCosF32 result;
  result.sin_value = intBitsToFloat(s_bits ^ exchange ^ ((quadrant & 2) << 30));
  result.cos_value = intBitsToFloat(c_bits ^ exchange ^ (((quadrant + 1) & 2) << 30));
  return result;
}

#endif
