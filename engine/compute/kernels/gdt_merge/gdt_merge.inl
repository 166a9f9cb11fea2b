// Merge of a scan's field into the global one, paper equations (9) to (11), in 16 bits throughout so that vectors hold
// twice as many cells; and a field copied into a larger one.

/// The parameters, limited to 16 bits if larger values mean the same, and the field's blank.
struct MergeLimits {
  std::uint16_t threshold;
  std::uint16_t lift;      ///< at most the cap
  std::uint16_t unlifted;  ///< cap - lift: a larger value reaches the cap when lifted
  std::uint16_t cap;
  std::uint16_t blank;
};

template <MergeRule kRule>
inline std::uint16_t merged(const MergeLimits& limits, std::uint16_t g, std::uint16_t d) {
  const std::uint16_t apart = u16(g < d ? d - g : g - d);
  const std::uint16_t average = u16((g & d) + ((g ^ d) >> 1));
  const std::uint16_t lifted = u16(u32(lesser(d, limits.unlifted)) + limits.lift);
  const bool tentative = kRule == MergeRule::kWorking ? g > d : g < d;
  std::uint16_t result = tentative ? lifted : g;
  result = apart <= limits.threshold ? average : result;
  result = g >= limits.cap ? d : result;
  return d >= limits.cap ? g : result;
}

inline MergeLimits merge_limits(std::uint32_t threshold, std::uint32_t most_lift, std::uint32_t cap,
                                std::uint32_t blank) {
  const std::uint32_t lift = lesser(most_lift, cap);
  return {u16(lesser(threshold, std::uint32_t{65535})), u16(lift), u16(cap - lift), u16(cap), u16(blank)};
}

template <MergeRule kRule>
inline void merge_row(const MergeLimits& shared_limits, std::uint16_t* __restrict global,
                      const std::uint16_t* __restrict scan, std::uint32_t count) {
  const MergeLimits limits = shared_limits;
  for (std::uint32_t x = 0; x < count; ++x) {
    const std::uint16_t value = u16(global[x] ^ limits.blank);
    global[x] = u16(merged<kRule>(limits, value, scan[x]) ^ limits.blank);
  }
}

/// Writes the first cell of a strip's row to the 65th of the strip before.
inline void repeat_before(std::uint16_t* row, std::uint32_t strip) {
  row[kStripWidth - static_cast<std::ptrdiff_t>(strip)] = row[0];
}

template <MergeRule kRule>
void merge_cells(const GdtMerge::Params& params, const MergeLimits& limits, std::uint16_t* global,
                 const std::uint16_t* scan, CellRange range) {
  const bool has_strips = params.global_strip != kStripWidth;
  for (std::uint32_t y = range.y_begin; y < range.y_end; ++y) {
    const std::uint16_t* row = scan + at(params.scan_stride, y);
    for (std::uint32_t x = range.x_begin; x < range.x_end;) {
      const std::uint32_t column = params.offset_x + x;
      std::uint16_t* out = global + at(params.global_strip, column / kStripWidth) + column % kStripWidth +
                           at(params.global_stride, params.offset_y + y);
      const std::uint32_t left = range.x_end - x;
      const std::uint32_t count = has_strips ? lesser(left, kStripWidth - column % kStripWidth) : left;
      merge_row<kRule>(limits, out, row + x, count);
      if (has_strips && column > 0 && column % kStripWidth == 0) {
        repeat_before(out, params.global_strip);
      }
      x += count;
    }
  }
}

void gdt_merge(const GdtMerge::Params& params, std::uint16_t* global, const std::uint16_t* scan, CellRange range) {
  const MergeLimits limits = merge_limits(params.threshold, params.lift, params.cap, params.blank);
  params.rule == MergeRule::kWorking ? merge_cells<MergeRule::kWorking>(params, limits, global, scan, range)
                                     : merge_cells<MergeRule::kLiteral>(params, limits, global, scan, range);
}

/// Columns [first, last) of the old field's row within those of a range; both are the range's end if there are none.
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
