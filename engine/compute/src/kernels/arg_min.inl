// Index of the smallest cost; the first among equals.

/// Values that are compared at once when looking for the smallest one's place.
constexpr std::uint32_t kArgMinBlock = 256;

void arg_min(const std::uint32_t* cost, std::uint32_t count, std::uint32_t* result) {
  std::uint32_t best = cost[0];
  for (std::uint32_t i = 1; i < count; ++i) {
    best = lesser(best, cost[i]);
  }
  std::uint32_t index = 0;
  for (bool found = false; !found && count - index > kArgMinBlock;) {
    std::uint32_t equal = 0;
    for (std::uint32_t i = 0; i < kArgMinBlock; ++i) {
      equal |= cost[index + i] == best ? 1U : 0U;
    }
    found = equal != 0;
    index += found ? 0 : kArgMinBlock;
  }
  while (cost[index] != best) {
    ++index;
  }
  result[0] = best;
  result[1] = index;
}
