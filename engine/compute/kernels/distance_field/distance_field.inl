// Squared distance to field cells, by table.

void distance_field(const DistanceField::Params& params, const std::uint16_t* sq_distance, const std::uint16_t* table,
                    std::uint16_t* field, CellRange range) {
  const std::uint32_t last = params.table_size - 1;
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint16_t* in = sq_distance + at(params.stride, y);
    std::uint16_t* out = field + at(params.stride, y);
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      out[x] = table[lesser(u32(in[x]), last)];
    }
  }
}
