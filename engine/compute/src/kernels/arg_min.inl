// Index of the smallest cost; the first among equals.

void arg_min(const std::uint32_t* cost, std::uint32_t count, std::uint32_t* result) {
  std::uint32_t best = cost[0];
  std::uint32_t index = 0;
  for (std::uint32_t i = 1; i < count; ++i) {
    if (cost[i] < best) {
      best = cost[i];
      index = i;
    }
  }
  result[0] = best;
  result[1] = index;
}
