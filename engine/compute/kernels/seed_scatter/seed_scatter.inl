// Seeds of a list of cells, paper equation (1).

void seed_scatter(const SeedScatter::Params& params, const std::uint32_t* cells, std::uint8_t* seeds, Slice list) {
  for (std::uint32_t i = list.begin; i < list.end; ++i) {
    const std::uint32_t x = cells[i] & 0xFFFFU;
    const std::uint32_t y = cells[i] >> 16U;
    if (x < params.width && y < params.height) {
      // Two threads may name the same cell: an atomic store, which is an ordinary one in the machine's code.
      __atomic_store_n(seeds + at(params.stride, y) + x, std::uint8_t{1}, __ATOMIC_RELAXED);
    }
  }
}
