// Merge of a scan's field into the global one, paper equations (9) to (11).

/// The new global value for global g and scan d, both 1/256 cell.
std::uint16_t merged(const GdtMerge::Params& params, std::uint32_t g, std::uint32_t d) {
  if (d >= params.cap) {
    return u16(g);
  }
  if (g >= params.cap) {
    return u16(d);
  }
  const std::uint32_t difference = g < d ? d - g : g - d;
  if (difference <= params.threshold) {
    return u16((g + d) >> 1);
  }
  const bool tentative = params.rule == MergeRule::kWorking ? g > d : g < d;
  return u16(tentative ? lesser(d + params.lift, params.cap) : g);
}

void gdt_merge(const GdtMerge::Params& params, std::uint16_t* global, const std::uint16_t* scan,
               const CellRange& range) {
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint16_t* in = scan + at(params.scan_stride, y);
    std::uint16_t* out = global + at(params.global_stride, params.offset_y + y) + params.offset_x;
    for (std::uint32_t x = range.x_begin; x < range.x_end; ++x) {
      out[x] = merged(params, out[x], in[x]);
    }
  }
}
