// A field moved into a larger one.

/// Columns [first, last) of the old field's row within those of a range; both are the range's end without any.
struct OldSpan {
  std::uint32_t first;
  std::uint32_t last;
};

OldSpan old_span(const FieldGrow::Params& params, bool crosses, const CellRange& range) {
  if (!crosses) {
    return {range.x_end, range.x_end};
  }
  return {lesser(greater(params.offset_x, range.x_begin), range.x_end),
          lesser(greater(params.offset_x + params.old_width, range.x_begin), range.x_end)};
}

void fill_row(std::uint16_t* out, std::size_t count, std::uint16_t value) {
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = value;
  }
}

void field_grow(const FieldGrow::Params& params, const std::uint16_t* old_field, std::uint16_t* field,
                CellRange range) {
  const std::uint16_t cap = u16(params.cap);
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const bool crosses = params.old_width > 0 && y >= params.offset_y && y - params.offset_y < params.old_height;
    const OldSpan span = old_span(params, crosses, range);
    std::uint16_t* out = field + at(params.stride, y);
    fill_row(out + range.x_begin, span.first - range.x_begin, cap);
    if (span.first < span.last) {
      const std::uint16_t* in = old_field + at(params.old_stride, y - params.offset_y) + (span.first - params.offset_x);
      __builtin_memcpy(out + span.first, in, std::size_t{span.last - span.first} * sizeof(std::uint16_t));
    }
    fill_row(out + span.last, range.x_end - span.last, cap);
  }
}
