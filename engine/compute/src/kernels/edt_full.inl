// Unlimited exact distance transform: columns by two sweeps, rows by the lower envelope of parabolas [Meijster2000].

void edt_full_columns(const EdtFullColumns::Params& params, const std::uint8_t* seeds, std::uint32_t* distance,
                      std::uint32_t begin, std::uint32_t end) {
  for (std::uint32_t x = begin; x < end; ++x) {
    distance[x] = seeds[x] != 0 ? 0 : kNoSeed;
  }
  for (std::uint32_t y = 1; y < params.height; ++y) {
    const std::uint8_t* seed = seeds + at(params.stride, y);
    std::uint32_t* row = distance + at(params.stride, y);
    const std::uint32_t* above = row - params.stride;
    for (std::uint32_t x = begin; x < end; ++x) {
      const std::uint32_t next = above[x] == kNoSeed ? kNoSeed : above[x] + 1;
      row[x] = seed[x] != 0 ? 0 : next;
    }
  }
  for (std::uint32_t y = params.height - 1; y-- > 0;) {
    std::uint32_t* row = distance + at(params.stride, y);
    const std::uint32_t* below = row + params.stride;
    for (std::uint32_t x = begin; x < end; ++x) {
      const std::uint32_t next = below[x] == kNoSeed ? kNoSeed : below[x] + 1;
      row[x] = lesser(row[x], next);
    }
  }
}

/// First column at which the parabola of `right` is strictly below that of `left` < `right`.
std::int64_t envelope_crossing(std::int64_t left, std::int64_t sq_left, std::int64_t right, std::int64_t sq_right) {
  const std::int64_t twice = right * right + sq_right - left * left - sq_left;
  const std::int64_t span = 2 * (right - left);
  const std::int64_t quotient = twice / span;
  return quotient - (twice % span < 0 ? 1 : 0) + 1;
}

/// Lower envelope of a row: sites in apex[0 .. count), apex[i] rules from column from[i] on. Returns the count.
std::uint32_t lower_envelope(std::uint32_t width, const std::uint32_t* in, std::uint32_t* apex, std::uint32_t* from) {
  std::uint32_t count = 0;
  for (std::uint32_t x = 0; x < width; ++x) {
    if (in[x] == kNoSeed) {
      continue;
    }
    const std::int64_t sq = static_cast<std::int64_t>(in[x]) * in[x];
    std::int64_t start = 0;
    while (count > 0) {
      const std::uint32_t top = apex[count - 1];
      start = envelope_crossing(top, static_cast<std::int64_t>(in[top]) * in[top], x, sq);
      if (start > from[count - 1]) {
        break;
      }
      --count;
      start = 0;
    }
    if (start < width) {
      apex[count] = x;
      from[count] = static_cast<std::uint32_t>(start < 0 ? 0 : start);
      ++count;
    }
  }
  return count;
}

void edt_full_rows(const EdtFullRows::Params& params, const std::uint32_t* distance, std::uint32_t* sq_distance,
                   std::uint32_t begin, std::uint32_t end, std::uint32_t* scratch) {
  std::uint32_t* apex = scratch;
  std::uint32_t* from = scratch + params.width;
  for (std::uint32_t y = begin; y < end; ++y) {
    const std::uint32_t* in = distance + at(params.stride, y);
    std::uint32_t* out = sq_distance + at(params.stride, y);
    const std::uint32_t count = lower_envelope(params.width, in, apex, from);
    std::uint32_t x = count == 0 ? 0 : params.width;
    for (std::uint32_t i = count; i-- > 0;) {
      const std::uint32_t sq_apex = in[apex[i]] * in[apex[i]];
      while (x > from[i]) {
        --x;
        const std::uint32_t dx = x - apex[i];
        out[x] = dx * dx + sq_apex;
      }
    }
    for (x = 0; count == 0 && x < params.width; ++x) {
      out[x] = kNoSeed;
    }
  }
}
