#include "engine/compute/cases/case_builder.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "pose_lattice.hpp"

namespace gdtslam {
namespace {

/// Samples of a window.
struct WindowSize {
  std::uint32_t xy;
  std::uint32_t theta;
  [[nodiscard]] std::uint32_t samples() const { return xy * xy * theta; }
  [[nodiscard]] std::string name() const {
    return std::to_string(xy) + "x" + std::to_string(xy) + "x" + std::to_string(theta);
  }
};

/// Sizes beyond those of vectors and tiles; smaller ones are tried in all pairs.
constexpr WindowSize kWindows[] = {{1, 100}, {16, 3}, {17, 4},  {31, 7},  {64, 2}, {65, 3},
                                   {101, 2}, {97, 5}, {257, 1}, {300, 2}, {2, 200}};
constexpr WindowSize kLargeWindow{317, 83};
constexpr WindowSize kBenchWindow{101, 41};  // +-1 m in steps of 2 cm, +-10 degrees in steps of half a degree

/// add(window, turn) for all pairs of counts up to kSmallSide.
template <class Add>
void for_each_small_window(Add add) {
  for (std::uint32_t theta = 1; theta <= kSmallSide; ++theta) {
    for (std::uint32_t xy = 1; xy <= kSmallSide; ++xy) {
      add(WindowSize{xy, theta}, theta * 7 + xy);
    }
  }
}

/// Priors: none, one like a scan's, one at its limit everywhere except near the mean, one of subnormal numbers.
enum class PriorKind : std::uint8_t { kNone, kWeak, kSteep, kSubnormal };

constexpr std::string_view kPriorNames[] = {"no prior", "weak prior", "steep prior", "subnormal prior"};

PriorParams make_prior(PriorKind kind, Random& random) {
  PriorParams prior;
  prior.mean_x = draw_real(random, 9.0);
  prior.mean_y = draw_real(random, 9.0);
  prior.mean_theta = draw_real(random, 0.3);
  if (kind == PriorKind::kWeak) {
    prior.weight_xy = static_cast<float>(random.uniform(10.0, 500.0));
    prior.weight_theta = static_cast<float>(random.uniform(1.0e4, 1.0e6));
  } else if (kind == PriorKind::kSteep) {
    prior.weight_xy = static_cast<float>(random.uniform(1.0e6, 1.0e9));
    prior.weight_theta = 3.0e38F;
    prior.limit = random.below(2) == 0 ? 1.0e9F : 12345.75F;
  } else if (kind == PriorKind::kSubnormal) {
    prior = {.mean_x = kSubnormal, .mean_y = -kSubnormal, .mean_theta = kSubnormal / 2.0F};
    prior.weight_xy = random.below(2) == 0 ? kSubnormal : 1000.0F;
    prior.weight_theta = random.below(2) == 0 ? kSubnormal : 1.0e5F;
    prior.limit = random.below(2) == 0 ? 1.0e9F : kSubnormal;
  }
  return prior;
}

KernelCase make_lattice_case(const std::string& named, WindowSize window, const PoseLattice::Params& params,
                             Random& random) {
  return make_case<PoseLattice>(named, params, {window.samples(), 1, 1}, {noise_buffer(4 * window.samples(), random)});
}

struct LatticeCase {
  using Kernel = PoseLattice;
  WindowSize window;
  PriorKind kind = PriorKind::kWeak;
  [[nodiscard]] std::string name() const {
    return window.name() + " " + std::string(kPriorNames[static_cast<std::size_t>(kind)]);
  }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    PoseLattice::Params params;
    params.centre_x = draw_real(random, 20.0);
    params.centre_y = draw_real(random, 20.0);
    params.centre_theta = draw_real(random, 3.2);
    params.step_cells = static_cast<float>(random.uniform(0.1, 2.0));
    params.step_rad = static_cast<float>(random.uniform(0.001, 0.05));
    params.count_xy = window.xy;
    params.count_theta = window.theta;
    params.prior = make_prior(kind, random);
    return make_lattice_case(named, window, params, random);
  }
};

/// A window around 0 in which the samples' differences from the prior's mean, or their squares, are subnormal; the
/// samples are not, because they are written.
struct SubnormalLattice {
  using Kernel = PoseLattice;
  PriorKind kind;
  std::string_view steps;
  float step;
  [[nodiscard]] std::string name() const {
    return "subnormal mean, steps of " + std::string(steps) + ", " +
           std::string(kPriorNames[static_cast<std::size_t>(kind)]);
  }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    constexpr WindowSize kWindow{9, 5};
    PoseLattice::Params params{
        .step_cells = step, .step_rad = step, .count_xy = kWindow.xy, .count_theta = kWindow.theta};
    params.prior = make_prior(kind, random);
    params.prior.mean_x = kSubnormal;
    params.prior.mean_y = params.prior.mean_theta = -kSubnormal;
    return make_lattice_case(named, kWindow, params, random);
  }
};

/// Costs of a window: `range` determines the number of ties; 0 stands for kNoCost everywhere.
std::vector<std::uint32_t> window_costs(std::uint32_t count, std::uint32_t range, Random& random) {
  std::vector<std::uint32_t> costs(count, kNoCost);
  for (std::uint32_t& cost : costs) {
    if (range > 0) {
      const auto drawn = static_cast<std::uint32_t>(random.below(range));
      cost = random.below(16) == 0 ? kNoCost - drawn % 3 : drawn;
    }
  }
  return costs;
}

std::string range_name(std::uint32_t range) {
  return range == 0 ? " no cost" : range == 1 ? " all equal" : " of " + std::to_string(range);
}

KernelCase make_minima_case(const std::string& named, WindowSize window, const std::vector<std::uint32_t>& costs,
                            Random& random) {
  return make_case<LatticeMinima>(named, {window.xy, window.theta}, {window.samples(), 1, 1},
                                  {list_buffer(costs), noise_buffer(window.samples(), random)});
}

struct MinimaCase {
  using Kernel = LatticeMinima;
  WindowSize window;
  std::uint32_t range;
  [[nodiscard]] std::string name() const { return window.name() + range_name(range); }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    std::vector<std::uint32_t> costs = window_costs(window.samples(), range, random);
    if (range == 1) {
      costs.assign(costs.size(), 7);
    }
    return make_minima_case(named, window, costs, random);
  }
};

/// A window with its lowest samples in its corners and in the middles of its edges and faces.
struct CornerMinima {
  using Kernel = LatticeMinima;
  WindowSize window;
  [[nodiscard]] std::string name() const { return window.name() + " corners"; }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    std::vector<std::uint32_t> costs(window.samples(), 1000);
    const auto ends = [](std::uint32_t n) { return std::vector<std::uint32_t>{0, n / 2, n - 1}; };
    for (const std::uint32_t t : ends(window.theta)) {
      for (const std::uint32_t y : ends(window.xy)) {
        for (const std::uint32_t x : ends(window.xy)) {
          costs[(t * window.xy + y) * window.xy + x] = 10 + t + y + x;
        }
      }
    }
    return make_minima_case(named, window, costs, random);
  }
};

KernelCase make_smallest_case(const std::string& named, const std::vector<std::uint32_t>& values, std::uint32_t wanted,
                              Random& random) {
  return make_case<SmallestValues>(named, {static_cast<std::uint32_t>(values.size()), wanted}, {1, 1, 1},
                                   {list_buffer(values), noise_buffer(2 * wanted, random)});
}

struct SmallestCase {
  using Kernel = SmallestValues;
  std::uint32_t count;
  std::uint32_t wanted;
  std::uint32_t range;
  [[nodiscard]] std::string name() const {
    return std::to_string(wanted) + " among " + std::to_string(count) + range_name(range);
  }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    return make_smallest_case(named, window_costs(count, range, random), wanted, random);
  }
};

/// Values that fall by one every `every` values, so that many enter the list, each just below the last one; every
/// fourth is kNoCost.
struct FallingCase {
  using Kernel = SmallestValues;
  std::uint32_t count;
  std::uint32_t wanted;
  std::uint32_t every;
  [[nodiscard]] std::string name() const {
    return std::to_string(wanted) + " among " + std::to_string(count) + " falling every " + std::to_string(every);
  }
  [[nodiscard]] KernelCase make(const std::string& named) const {
    Random random(seed_from(named));
    std::vector<std::uint32_t> values(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      values[i] = i % 4 == 3 ? kNoCost : kNoCost - 1 - i / every;
    }
    return make_smallest_case(named, values, wanted, random);
  }
};

WindowSize draw_window(Random& random) {
  const std::uint32_t xy = 1 + draw_count(random, 40);
  return {xy, 1 + draw_count(random, 20)};
}

constexpr PriorKind kPriors[] = {PriorKind::kNone, PriorKind::kWeak, PriorKind::kSteep};
constexpr std::uint32_t kRanges[] = {0, 1, 3, 1U << 30U};

KernelCase draw_lattice(const std::string& name, Random& random) {
  const WindowSize window = draw_window(random);
  return LatticeCase{window, draw_from(random, kPriors)}.make(name);
}
KernelCase draw_minima(const std::string& name, Random& random) {
  const WindowSize window = draw_window(random);
  return MinimaCase{window, draw_count(random, 1U << 31U)}.make(name);
}
KernelCase draw_smallest(const std::string& name, Random& random) {
  const std::uint32_t count = draw_count(random, 100000);
  const auto wanted = static_cast<std::uint32_t>(1 + random.below(SmallestValues::kMost));
  return SmallestCase{count, wanted, draw_count(random, 1U << 31U)}.make(name);
}

void add_lattices(std::vector<KernelCaseSource>& list) {
  for (const WindowSize& window : kWindows) {
    for (const PriorKind kind : kPriors) {
      add_case(list, LatticeCase{window, kind});
    }
  }
  for_each_small_window([&](WindowSize window, std::uint32_t turn) {
    add_case(list, LatticeCase{window, in_turn(kPriors, turn)});
  });
  for (const PriorKind kind : {PriorKind::kWeak, PriorKind::kSubnormal}) {
    add_case(list, SubnormalLattice{kind, "1", 1.0F});
    add_case(list, SubnormalLattice{kind, "1e-22", 1.0e-22F});
    add_case(list, SubnormalLattice{kind, "1e-37", 1.0e-37F});
  }
  add_case(list, LatticeCase{kLargeWindow}, CaseUse::kLarge);
  add_case(list, LatticeCase{kBenchWindow, PriorKind::kWeak}, CaseUse::kBenchmark);
}

void add_window_minima(std::vector<KernelCaseSource>& list) {
  for (const WindowSize& window : kWindows) {
    for (const std::uint32_t range : kRanges) {
      add_case(list, MinimaCase{window, range});
    }
    add_case(list, CornerMinima{window});
  }
  for_each_small_window([&](WindowSize window, std::uint32_t turn) {
    add_case(list, MinimaCase{window, in_turn(kRanges, turn)});
    add_case(list, MinimaCase{window, in_turn(kRanges, turn + 2)});
  });
  add_case(list, MinimaCase{kLargeWindow, 1U << 12U}, CaseUse::kLarge);
  add_case(list, MinimaCase{kBenchWindow, 1U << 20U}, CaseUse::kBenchmark);
}

void add_smallest_lists(std::vector<KernelCaseSource>& list) {
  for (const std::uint32_t count : {0U, 1U, 2U, 15U, 16U, 17U, 63U, 64U, 65U, 255U, 1000U, 70001U}) {
    for (const std::uint32_t wanted : {1U, 2U, 8U, 16U}) {
      for (const std::uint32_t range : kRanges) {
        add_case(list, SmallestCase{count, wanted, range});
      }
      add_case(list, FallingCase{count, wanted, 1});
      add_case(list, FallingCase{count, wanted, 64});
    }
  }
  // The least value is the last one, at each position of a block that an invocation of a group of some size processes
  // at once.
  for (const auto& [group, wanted] : {std::pair{8U, 3U}, std::pair{128U, 4U}, std::pair{1024U, 5U}}) {
    for (std::uint32_t place = 1; place < SmallestValues::kMost; ++place) {
      add_case(list, FallingCase{group * place + 1, wanted, 1});
    }
  }
  for (std::uint32_t count = 18; count < 63; ++count) {
    add_case(list, SmallestCase{count, 1 + count % SmallestValues::kMost,
                                in_turn(kRanges, count + count / SmallestValues::kMost)});
  }
  add_case(list, SmallestCase{16777259, 16, 1U << 31U}, CaseUse::kLarge);
  add_case(list, SmallestCase{kBenchWindow.samples(), 8, 1U << 30U}, CaseUse::kBenchmark);
}

void add_pose_lattice_cases(std::vector<KernelCaseSource>& list) {
  add_lattices(list);
  add_window_minima(list);
  add_smallest_lists(list);
}

}  // namespace

CaseGroup PoseLattice::cases() {
  return {add_pose_lattice_cases,
          {{&PoseLattice::info(), draw_lattice},
           {&LatticeMinima::info(), draw_minima},
           {&SmallestValues::info(), draw_smallest}}};
}

}  // namespace gdtslam
