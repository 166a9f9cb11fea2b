#include <algorithm>
#include <limits>

#include "engine/compute/cases/case_builder.hpp"
#include "engine/core/elementary.hpp"
#include "sweep_points.hpp"

namespace gdtslam {
namespace {

/// What a launch is made of.
struct SweepCase {
  std::uint32_t beams = 0;
  std::uint32_t strips = 1;
  std::uint32_t directions = 1;
  std::uint32_t bits = 0;
  SweepForm form = SweepForm::kWorking;
  /// As the assembler makes them; anything: lengths, tables and indices that no scan has; huge: coordinates that
  /// overflow.
  enum class Kind : std::uint8_t { kScans, kAnything, kHuge } kind = Kind::kScans;

  [[nodiscard]] std::string name() const {
    constexpr const char* kKinds[] = {"", " anything", " huge"};
    return std::to_string(beams) + " beams " + std::to_string(strips) + " strips " + std::to_string(directions) +
           " directions " + std::to_string(bits) + " bits" + (form == SweepForm::kLiteral ? " literal" : "") +
           kKinds[static_cast<std::size_t>(kind)];
  }
};

float real(Random& random, double most) { return static_cast<float>(random.uniform(-most, most)); }
std::uint32_t word(Random& random) { return static_cast<std::uint32_t>(random.bits() >> 32U); }

/// Mostly ranges of a scanner; some that are none, and the extremes of what counts as one.
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
                                                     : real(random, 6.0);
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

/// The part of a strip that every kind draws alike.
BeamStrip sweep_strip(Random& random, double far) {
  BeamStrip strip;
  strip.phase = word(random);
  strip.phase_step = static_cast<std::uint32_t>(random.below(1U << 20U)) - (1U << 19U);
  strip.x_m = real(random, far);
  strip.y_m = real(random, far);
  strip.yaw_rad = real(random, 3.2);
  strip.x_step_m = real(random, 0.001);
  strip.y_step_m = real(random, 0.001);
  strip.yaw_step_rad = real(random, 0.001);
  strip.outer_x_m = real(random, far);
  strip.outer_y_m = real(random, far);
  const SinCos<double> outer = sin_cos(random.uniform(-3.2, 3.2));
  strip.outer_cos = static_cast<float>(outer.cos);
  strip.outer_sin = static_cast<float>(outer.sin);
  strip.unused_0 = word(random);
  strip.unused_1 = word(random);
  return strip;
}

void append_beams(std::uint64_t count, std::uint32_t strip, Random& random, std::vector<BeamRange>& beams) {
  for (std::uint64_t i = 0; i < count; ++i) {
    beams.push_back({sweep_range(random), strip});
  }
}

/// Strips of a batch, one behind the other.
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

/// Strips without any order: those beyond the table, those that begin behind their beams, offsets beyond 2^24,
/// directions that wrap.
void add_wild_strips(const SweepCase& sweep, Random& random, std::vector<BeamStrip>& strips,
                     std::vector<BeamRange>& beams) {
  const double far = sweep.kind == SweepCase::Kind::kHuge ? 1.0e37 : 100.0;
  for (std::uint32_t s = 0; s < sweep.strips; ++s) {
    BeamStrip strip = sweep_strip(random, far);
    strip.first_beam = random.below(2) == 0 ? static_cast<std::uint32_t>(random.below(sweep.beams + 1)) : word(random);
    strip.first_direction =
        random.below(2) == 0 ? static_cast<std::uint32_t>(random.below(sweep.directions)) : word(random);
    strip.phase_step = word(random);
    if (sweep.kind == SweepCase::Kind::kHuge) {
      strip.yaw_rad = real(random, 1.0e6);
      strip.x_step_m = real(random, 1.0e37);
      strip.outer_cos = real(random, 20.0);
      strip.outer_y_m = real(random, 3.4e38);
    }
    strips.push_back(strip);
  }
  while (beams.size() < sweep.beams) {
    const std::uint32_t named =
        random.below(8) == 0 ? word(random) : static_cast<std::uint32_t>(random.below(sweep.strips + 1));
    const std::uint64_t run = std::min<std::uint64_t>(1 + random.below(40), sweep.beams - beams.size());
    append_beams(run, named, random, beams);
  }
}

KernelCase sweep_case(const std::string& name, const SweepCase& sweep) {
  Random random(seed_from(name));
  SweepPoints::Params params;
  params.beams = sweep.beams;
  params.strips = sweep.strips;
  params.directions = sweep.directions;
  params.table_bits = sweep.bits;
  params.lever_x_m = random.below(4) == 0 ? 0.0F : real(random, 0.2);
  params.lever_z_m = random.below(4) == 0 ? 0.0F : real(random, 0.2);
  params.height_m = real(random, 1.0);
  params.form = sweep.form;
  std::vector<BeamStrip> strips;
  std::vector<BeamRange> beams;
  if (sweep.kind == SweepCase::Kind::kScans) {
    add_scan_strips(sweep, random, strips, beams);
  } else {
    add_wild_strips(sweep, random, strips, beams);
  }
  std::vector<float> tables = sweep_table(sweep, random);
  append_directions(sweep, random, tables);
  const std::uint32_t words = 4 * sweep.beams;
  CaseBuffer points = list_buffer(noise<std::uint32_t>({words, 1, words}, random.bits()));
  points.layout = {16, sweep.beams, 1, sweep.beams};
  return make_case<SweepPoints>(name, params, {sweep.beams, 1, 1},
                                {list_buffer(beams), list_buffer(strips), list_buffer(tables), points});
}

void add_sweep(std::vector<KernelCaseSource>& list, const SweepCase& sweep, bool benchmark = false) {
  add_case<SweepPoints>(
      list, sweep.name(), [sweep](const std::string& name) { return sweep_case(name, sweep); }, benchmark);
}

constexpr SweepForm kForms[] = {SweepForm::kWorking, SweepForm::kLiteral};
constexpr SweepCase::Kind kKinds[] = {SweepCase::Kind::kScans, SweepCase::Kind::kAnything, SweepCase::Kind::kHuge};

KernelCase draw_sweep(const std::string& name, Random& random) {
  SweepCase sweep;
  sweep.beams = draw_count(random, 3000);
  sweep.strips = 1 + draw_count(random, 50);
  sweep.directions = 1 + draw_count(random, 1100);
  sweep.bits = static_cast<std::uint32_t>(random.below(13));
  sweep.form = draw_from(random, kForms);
  sweep.kind = draw_from(random, kKinds);
  return sweep_case(name, sweep);
}

}  // namespace

void add_sweep_points_cases(std::vector<KernelCaseSource>& list) {
  // Below, at and beyond vectors, tiles and work groups.
  std::uint32_t turn = 0;
  for (const std::uint32_t beams : {0U,  1U,  2U,  3U,   4U,   5U,   7U,   8U,   9U,   15U,  16U,  17U,   31U,
                                    32U, 33U, 63U, 127U, 128U, 129U, 255U, 256U, 257U, 511U, 961U, 1021U, 4099U}) {
    for (const SweepCase::Kind kind : kKinds) {
      add_sweep(list, {beams, 1 + turn % 5, 1 + 31 * (turn % 40), turn % 14, in_turn(kForms, turn), kind});
      ++turn;
    }
  }
  for (std::uint32_t bits = 0; bits <= 20; ++bits) {
    for (const SweepForm form : kForms) {
      add_sweep(list, {300, 7, 50, bits, form, SweepCase::Kind::kScans});
      add_sweep(list, {300, 7, 50, bits, form, SweepCase::Kind::kAnything});
    }
  }
  add_sweep(list, {5000, 5000, 1, 5, SweepForm::kWorking, SweepCase::Kind::kScans});  // a strip a beam
  add_sweep(list, {5000, 1, 5000, 5, SweepForm::kLiteral, SweepCase::Kind::kScans});
  add_large_case<SweepPoints>(list, "more beams than one row of groups", [](const std::string& name) {
    return sweep_case(name, {65535 * 128 + 77, 300, 961, 15, SweepForm::kWorking, SweepCase::Kind::kScans});
  });
  add_sweep(list, {961 * 273, 273 * 4, 961, 15, SweepForm::kWorking, SweepCase::Kind::kScans}, true);
}

void add_sweep_points_draws(std::vector<RandomKernel>& list) { list.push_back({&SweepPoints::info(), draw_sweep}); }

}  // namespace gdtslam
