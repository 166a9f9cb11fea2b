// A field moved into a larger one.

void field_grow(const FieldGrow::Params& params, const std::uint16_t* old_field, std::uint16_t* field,
                CellRange range) {
  const std::uint16_t cap = u16(params.cap);
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const bool crosses = params.old_width > 0 && y >= params.offset_y && y - params.offset_y < params.old_height;
    // Columns [first, last) come from the old field; without any, both are the end of the range.
    std::uint32_t first = crosses ? params.offset_x : range.x_end;
    std::uint32_t last = crosses ? params.offset_x + params.old_width : range.x_end;
    first = lesser(greater(first, range.x_begin), range.x_end);
    last = lesser(greater(last, range.x_begin), range.x_end);
    std::uint16_t* out = field + at(params.stride, y);
    for (std::uint32_t x = range.x_begin; x < first; ++x) {
      out[x] = cap;
    }
    const std::uint16_t* in = old_field + (crosses ? at(params.old_stride, y - params.offset_y) : 0);
    for (std::uint32_t x = first; x < last; ++x) {
      out[x] = in[x - params.offset_x];
    }
    for (std::uint32_t x = last; x < range.x_end; ++x) {
      out[x] = cap;
    }
  }
}
