// The few smallest of many values. Whole blocks are looked at for anything that could enter the list, which is rare.

constexpr std::uint32_t kSmallestBlock = 64;

/// The smallest values so far, ascending; entries that are missing are kNoCost.
struct SmallestList {
  std::uint32_t value[SmallestValues::kMost];
  std::uint32_t index[SmallestValues::kMost];
  std::uint32_t wanted;
};

/// Puts a value below the last one into its place, behind its equals: they came earlier.
void insert_small(SmallestList& list, std::uint32_t value, std::uint32_t index) {
  std::uint32_t place = list.wanted - 1;
  while (place > 0 && list.value[place - 1] > value) {
    list.value[place] = list.value[place - 1];
    list.index[place] = list.index[place - 1];
    --place;
  }
  list.value[place] = value;
  list.index[place] = index;
}

void insert_smaller(SmallestList& list, const std::uint32_t* values, std::uint32_t begin, std::uint32_t end) {
  for (std::uint32_t i = begin; i < end; ++i) {
    if (values[i] < list.value[list.wanted - 1]) {
      insert_small(list, values[i], i);
    }
  }
}

void smallest_values(const SmallestValues::Params& params, const std::uint32_t* values, std::uint32_t* picks) {
  SmallestList list;
  list.wanted = params.wanted;
  for (std::uint32_t i = 0; i < params.wanted; ++i) {
    list.value[i] = kNoCost;
    list.index[i] = kNoCost;
  }
  const std::uint32_t whole = params.count - params.count % kSmallestBlock;
  for (std::uint32_t first = 0; first < whole; first += kSmallestBlock) {
    std::uint32_t least = kNoCost;
    for (std::uint32_t i = 0; i < kSmallestBlock; ++i) {
      least = lesser(least, values[first + i]);
    }
    if (least < list.value[list.wanted - 1]) {
      insert_smaller(list, values, first, first + kSmallestBlock);
    }
  }
  insert_smaller(list, values, whole, params.count);
  for (std::uint32_t i = 0; i < params.wanted; ++i) {
    picks[2 * i] = list.value[i];
    picks[2 * i + 1] = list.index[i];
  }
}
