#include <algorithm>
#include <limits>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/core/elementary.hpp"
#include "sweep_points.hpp"

namespace gdtslam {
namespace {

/// Parameters of a launch.
struct SweepCase {
  using Kernel = SweepPoints;
  std::uint32_t beams = 0;
  std::uint32_t strips = 1;
  std::uint32_t directions = 1;
  std::uint32_t bits = 0;
  SweepForm form = SweepForm::kWorking;
  /// Kinds of launches. Scans: like those of the assembler; anything: lengths, tables and indices that no scan has;
  /// huge: coordinates that overflow.
  enum class Kind : std::uint8_t { kScans, kAnything, kHuge } kind = Kind::kScans;

  [[nodiscard]] std::string name() const {
    constexpr const char* kKinds[] = {"", " anything", " huge"};
    return std::to_string(beams) + " beams " + std::to_string(strips) + " strips " + std::to_string(directions) +
           " directions " + std::to_string(bits) + " bits" + (form == SweepForm::kLiteral ? " literal" : "") +
           kKinds[static_cast<std::size_t>(kind)];
  }
  [[nodiscard]] KernelCase make(const std::string& named) const;
};

/// Mostly valid ranges of a scanner; some invalid ones, and the extremes of valid ones.
float sweep_range(Random& random) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr float kOdd[] = {0.0F,
                            -0.0F,
                            -1.0F,
                            kInfinity,
                            -kInfinity,
                            std::numeric_limits<float>::quiet_NaN(),
                            -std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::max(),
                            std::numeric_limits<float>::min(),
                            std::numeric_limits<float>::denorm_min(),
                            1.0e-12F,
                            1.0e-13F};
  return random.below(6) == 0 ? draw_from(random, kOdd) : static_cast<float>(random.uniform(0.05, 30.0));
}

/// Elevations over a turn: a swing, or steps without any order.
std::vector<float> sweep_table(const SweepCase& sweep, Random& random) {
  const std::size_t cells = std::size_t{1} << sweep.bits;
  std::vector<float> table(cells + 1);
  for (std::size_t i = 0; i <= cells; ++i) {
    const double turn = static_cast<double>(i) / static_cast<double>(cells);
    table[i] = sweep.kind == SweepCase::Kind::kScans ? static_cast<float>(0.7 - 0.8 * sin_cos(6.28318 * turn).cos)
                                                     : draw_real(random, 6.0);
  }
  if (sweep.kind != SweepCase::Kind::kScans) {
    table[random.below(cells + 1)] = std::numeric_limits<float>::quiet_NaN();
    table[random.below(cells + 1)] = 1.0e-13F;
    table[cells] = 1.0e-30F;
    if (cells >= 8) {  // just large enough to count, just too small, infinite
      table[1] = table[2] = 0x1p-40F;
      table[4] = table[5] = 0x1.fffffep-41F;
      table[7] = std::numeric_limits<float>::infinity();
    }
  }
  return table;
}

void append_directions(const SweepCase& sweep, Random& random, std::vector<float>& tables) {
  for (std::uint32_t i = 0; i < sweep.directions; ++i) {
    const SinCos<double> bearing = sin_cos(random.uniform(-3.2, 3.2));
    const SinCos<double> roll = sin_cos(random.uniform(-0.1, 0.1));
    tables.push_back(static_cast<float>(bearing.cos));
    tables.push_back(static_cast<float>(bearing.sin * roll.cos));
    tables.push_back(static_cast<float>(bearing.sin * roll.sin));
  }
}

/// The part of a strip that is drawn in the same way for every kind.
BeamStrip sweep_strip(Random& random, double far) {
  BeamStrip strip;
  strip.phase = draw_word(random);
  strip.phase_step = static_cast<std::uint32_t>(random.below(1U << 20U)) - (1U << 19U);
  strip.x_m = draw_real(random, far);
  strip.y_m = draw_real(random, far);
  strip.yaw_rad = draw_real(random, 3.2);
  strip.x_step_m = draw_real(random, 0.001);
  strip.y_step_m = draw_real(random, 0.001);
  strip.yaw_step_rad = draw_real(random, 0.001);
  strip.outer_x_m = draw_real(random, far);
  strip.outer_y_m = draw_real(random, far);
  const SinCos<double> outer = sin_cos(random.uniform(-3.2, 3.2));
  strip.outer_cos = static_cast<float>(outer.cos);
  strip.outer_sin = static_cast<float>(outer.sin);
  strip.unused_0 = draw_word(random);
  strip.unused_1 = draw_word(random);
  return strip;
}

void append_beams(std::uint64_t count, std::uint32_t strip, Random& random, std::vector<BeamRange>& beams) {
  for (std::uint64_t i = 0; i < count; ++i) {
    beams.push_back({sweep_range(random), strip});
  }
}

/// Consecutive strips of a batch.
void add_scan_strips(const SweepCase& sweep, Random& random, std::vector<BeamStrip>& strips,
                     std::vector<BeamRange>& beams) {
  for (std::uint32_t s = 0; s < sweep.strips; ++s) {
    BeamStrip strip = sweep_strip(random, 20.0);
    strip.first_beam = static_cast<std::uint32_t>(std::uint64_t{sweep.beams} * s / sweep.strips);
    const auto last = static_cast<std::uint32_t>(std::uint64_t{sweep.beams} * (s + 1) / sweep.strips);
    const std::uint32_t length = last - strip.first_beam;
    strip.first_direction =
        sweep.directions > length ? static_cast<std::uint32_t>(random.below(sweep.directions - length + 1)) : 0;
    strips.push_back(strip);
    append_beams(length, s, random, beams);
  }
}

/// Strips without any order: beyond the table, with a start after their beams, offsets beyond 2^24, directions that
/// wrap.
void add_wild_strips(const SweepCase& sweep, Random& random, std::vector<BeamStrip>& strips,
                     std::vector<BeamRange>& beams) {
  const double far = sweep.kind == SweepCase::Kind::kHuge ? 1.0e37 : 100.0;
  for (std::uint32_t s = 0; s < sweep.strips; ++s) {
    BeamStrip strip = sweep_strip(random, far);
    strip.first_beam =
        random.below(2) == 0 ? static_cast<std::uint32_t>(random.below(sweep.beams + 1)) : draw_word(random);
    strip.first_direction =
        random.below(2) == 0 ? static_cast<std::uint32_t>(random.below(sweep.directions)) : draw_word(random);
    strip.phase_step = draw_word(random);
    if (sweep.kind == SweepCase::Kind::kHuge) {
      strip.yaw_rad = draw_real(random, 1.0e6);
      strip.x_step_m = draw_real(random, 1.0e37);
      strip.outer_cos = draw_real(random, 20.0);
      strip.outer_y_m = draw_real(random, 3.4e38);
    }
    strips.push_back(strip);
  }
  while (beams.size() < sweep.beams) {
    const std::uint32_t named =
        random.below(8) == 0 ? draw_word(random) : static_cast<std::uint32_t>(random.below(sweep.strips + 1));
    const std::uint64_t run = std::min<std::uint64_t>(1 + random.below(40), sweep.beams - beams.size());
    append_beams(run, named, random, beams);
  }
}

KernelCase SweepCase::make(const std::string& named) const {
  Random random(seed_from(named));
  SweepPoints::Params params;
  params.beams = beams;
  params.strips = strips;
  params.directions = directions;
  params.table_bits = bits;
  params.lever_x_m = random.below(4) == 0 ? 0.0F : draw_real(random, 0.2);
  params.lever_z_m = random.below(4) == 0 ? 0.0F : draw_real(random, 0.2);
  params.height_m = draw_real(random, 1.0);
  params.form = form;
  std::vector<BeamStrip> strip_list;
  std::vector<BeamRange> ranges;
  if (kind == SweepCase::Kind::kScans) {
    add_scan_strips(*this, random, strip_list, ranges);
  } else {
    add_wild_strips(*this, random, strip_list, ranges);
  }
  std::vector<float> tables = sweep_table(*this, random);
  append_directions(*this, random, tables);
  CaseBuffer points = noise_buffer(4 * beams, random);
  points.layout = {16, beams, 1, beams};
  return make_case<SweepPoints>(named, params, {beams, 1, 1},
                                {list_buffer(ranges), list_buffer(strip_list), list_buffer(tables), points});
}

constexpr SweepForm kSweepForms[] = {SweepForm::kWorking, SweepForm::kLiteral};
constexpr SweepCase::Kind kKinds[] = {SweepCase::Kind::kScans, SweepCase::Kind::kAnything, SweepCase::Kind::kHuge};

KernelCase draw_sweep(const std::string& name, Random& random) {
  SweepCase sweep;
  sweep.beams = draw_count(random, 3000);
  sweep.strips = 1 + draw_count(random, 50);
  sweep.directions = 1 + draw_count(random, 1100);
  sweep.bits = static_cast<std::uint32_t>(random.below(13));
  sweep.form = draw_from(random, kSweepForms);
  sweep.kind = draw_from(random, kKinds);
  return sweep.make(name);
}

void add_sweep_points_cases(std::vector<KernelCaseSource>& list) {
  // Below, at and beyond vectors, tiles and work groups.
  std::uint32_t turn = 0;
  for (const std::uint32_t beams : {0U,  1U,  2U,  3U,   4U,   5U,   7U,   8U,   9U,   15U,  16U,  17U,   31U,
                                    32U, 33U, 63U, 127U, 128U, 129U, 255U, 256U, 257U, 511U, 961U, 1021U, 4099U}) {
    for (const SweepCase::Kind kind : kKinds) {
      add_case(list, SweepCase{beams, 1 + turn % 5, 1 + 31 * (turn % 40), turn % 14, in_turn(kSweepForms, turn), kind});
      ++turn;
    }
  }
  for (std::uint32_t bits = 0; bits <= 20; ++bits) {
    for (const SweepForm form : kSweepForms) {
      add_case(list, SweepCase{300, 7, 50, bits, form, SweepCase::Kind::kScans});
      add_case(list, SweepCase{300, 7, 50, bits, form, SweepCase::Kind::kAnything});
    }
  }
  add_case(list, SweepCase{5000, 5000, 1, 5});  // a strip a beam
  add_case(list, SweepCase{5000, 1, 5000, 5, SweepForm::kLiteral, SweepCase::Kind::kScans});
  // More beams than one row of groups.
  add_case(list, SweepCase{65535 * 128 + 77, 300, 961, 15}, CaseUse::kLarge);
  add_case(list, SweepCase{961 * 273, 273 * 4, 961, 15}, CaseUse::kBenchmark);
}

}  // namespace

CaseGroup SweepPoints::cases() { return {add_sweep_points_cases, {{&SweepPoints::info(), draw_sweep}}}; }

}  // namespace gdtslam
