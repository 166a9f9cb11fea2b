// The rule of the merge, paper equations (9) to (11), for four cells; the including shader has threshold, lift, cap and
// rule among its parameters.
#ifndef GDTSLAM_MERGE_RULE_GLSL
#define GDTSLAM_MERGE_RULE_GLSL

const uint kLiteral = 1;

uvec4 merged(uvec4 g, uvec4 d) {
  uint shift = min(lift, cap);  // a value lifted beyond the cap is the cap
  uvec4 apart = max(g, d) - min(g, d);
  uvec4 lifted = min(d, uvec4(cap - shift)) + shift;
  bvec4 is_tentative = rule == kLiteral ? lessThan(g, d) : greaterThan(g, d);
  uvec4 result = mix(g, lifted, is_tentative);
  result = mix(result, (g + d) >> 1, lessThanEqual(apart, uvec4(threshold)));
  result = mix(result, d, greaterThanEqual(g, uvec4(cap)));
  return mix(result, g, greaterThanEqual(d, uvec4(cap)));
}

#endif
