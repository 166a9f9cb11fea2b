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

/// Beyond the sizes of vectors and tiles; smaller ones are tried in all pairs.
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

/// Priors: none, one as a scan has it, one that is at its limit everywhere but near the mean, one of subnormal numbers.
enum class PriorKind : std::uint8_t { kNone, kWeak, kSteep, kSubnormal };

std::string_view to_string(PriorKind kind) {
  switch (kind) {
    case PriorKind::kNone:
      return "no prior";
    case PriorKind::kWeak:
      return "weak prior";
    case PriorKind::kSteep:
      return "steep prior";
    case PriorKind::kSubnormal:
      break;
  }
  return "subnormal prior";
}

PriorParams make_prior(PriorKind kind, Random& random) {
  PriorParams prior;
  prior.mean_x = static_cast<float>(random.uniform(-9.0, 9.0));
  prior.mean_y = static_cast<float>(random.uniform(-9.0, 9.0));
  prior.mean_theta = static_cast<float>(random.uniform(-0.3, 0.3));
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

KernelCase lattice_case(const std::string& name, WindowSize window, PriorKind kind) {
  Random random(seed_from(name));
  PoseLattice::Params params;
  params.centre_x = static_cast<float>(random.uniform(-20.0, 20.0));
  params.centre_y = static_cast<float>(random.uniform(-20.0, 20.0));
  params.centre_theta = static_cast<float>(random.uniform(-3.2, 3.2));
  params.step_cells = static_cast<float>(random.uniform(0.1, 2.0));
  params.step_rad = static_cast<float>(random.uniform(0.001, 0.05));
  params.count_xy = window.xy;
  params.count_theta = window.theta;
  params.prior = make_prior(kind, random);
  const std::uint32_t words = 4 * window.samples();
  return make_case<PoseLattice>(name, params, {window.samples(), 1, 1},
                                {list_buffer(noise<std::uint32_t>({words, 1, words}, random.bits()))});
}

/// A window around 0 whose samples' differences to the prior's mean, or their squares, are subnormal; the samples are
/// not, since they are what is written.
KernelCase subnormal_lattice(const std::string& name, WindowSize window, float step, PriorKind kind) {
  Random random(seed_from(name));
  PoseLattice::Params params{.step_cells = step, .step_rad = step, .count_xy = window.xy, .count_theta = window.theta};
  params.prior = make_prior(kind, random);
  params.prior.mean_x = kSubnormal;
  params.prior.mean_y = params.prior.mean_theta = -kSubnormal;
  const std::uint32_t words = 4 * window.samples();
  return make_case<PoseLattice>(name, params, {window.samples(), 1, 1},
                                {list_buffer(noise<std::uint32_t>({words, 1, words}, random.bits()))});
}

void add_lattice(std::vector<KernelCaseSource>& list, WindowSize window, PriorKind kind, bool benchmark = false) {
  add_case<PoseLattice>(
      list, window.name() + " " + std::string(to_string(kind)),
      [=](const std::string& name) { return lattice_case(name, window, kind); }, benchmark);
}

/// Costs of a window: how many values there are decides how many ties; 0 stands for kNoCost everywhere.
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

KernelCase minima_case(const std::string& name, WindowSize window, std::uint32_t range) {
  Random random(seed_from(name));
  const std::uint32_t count = window.samples();
  std::vector<std::uint32_t> costs = window_costs(count, range, random);
  if (range == 1) {
    costs.assign(count, 7);
  }
  return make_case<LatticeMinima>(
      name, {window.xy, window.theta}, {count, 1, 1},
      {list_buffer(costs), list_buffer(noise<std::uint32_t>({count, 1, count}, random.bits()))});
}

void add_minima(std::vector<KernelCaseSource>& list, WindowSize window, std::uint32_t range, bool benchmark = false) {
  add_case<LatticeMinima>(
      list, window.name() + range_name(range),
      [=](const std::string& name) { return minima_case(name, window, range); }, benchmark);
}

/// A window whose lowest samples lie in its corners and in the middles of its edges and faces.
void add_corner_minima(std::vector<KernelCaseSource>& list, WindowSize window) {
  add_case<LatticeMinima>(list, window.name() + " corners", [=](const std::string& named) {
    const std::uint32_t count = window.samples();
    std::vector<std::uint32_t> costs(count, 1000);
    const auto ends = [](std::uint32_t n) { return std::vector<std::uint32_t>{0, n / 2, n - 1}; };
    for (const std::uint32_t t : ends(window.theta)) {
      for (const std::uint32_t y : ends(window.xy)) {
        for (const std::uint32_t x : ends(window.xy)) {
          costs[(t * window.xy + y) * window.xy + x] = 10 + t + y + x;
        }
      }
    }
    return make_case<LatticeMinima>(named, {window.xy, window.theta}, {count, 1, 1},
                                    {list_buffer(costs), list_buffer(std::vector<std::uint32_t>(count, 5))});
  });
}

KernelCase smallest_case(const std::string& name, std::uint32_t count, std::uint32_t wanted, std::uint32_t range) {
  Random random(seed_from(name));
  return make_case<SmallestValues>(name, {count, wanted}, {1, 1, 1},
                                   {list_buffer(window_costs(count, range, random)),
                                    list_buffer(noise<std::uint32_t>({2 * wanted, 1, 2 * wanted}, random.bits()))});
}

void add_smallest(std::vector<KernelCaseSource>& list, std::uint32_t count, std::uint32_t wanted, std::uint32_t range,
                  bool benchmark = false) {
  add_case<SmallestValues>(
      list, std::to_string(wanted) + " among " + std::to_string(count) + range_name(range),
      [=](const std::string& name) { return smallest_case(name, count, wanted, range); }, benchmark);
}

/// Values that fall by one every `every` values, so that many enter the list, each just below the last one; every
/// fourth is kNoCost.
void add_falling(std::vector<KernelCaseSource>& list, std::uint32_t count, std::uint32_t wanted, std::uint32_t every) {
  const std::string name =
      std::to_string(wanted) + " among " + std::to_string(count) + " falling every " + std::to_string(every);
  add_case<SmallestValues>(list, name, [=](const std::string& named) {
    std::vector<std::uint32_t> values(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      values[i] = i % 4 == 3 ? kNoCost : kNoCost - 1 - i / every;
    }
    return make_case<SmallestValues>(named, {count, wanted}, {1, 1, 1},
                                     {list_buffer(values), list_buffer(std::vector<std::uint32_t>(2 * wanted, 9))});
  });
}

WindowSize draw_window(Random& random) {
  const std::uint32_t xy = 1 + draw_count(random, 40);
  return {xy, 1 + draw_count(random, 20)};
}

constexpr PriorKind kPriors[] = {PriorKind::kNone, PriorKind::kWeak, PriorKind::kSteep};
constexpr std::uint32_t kRanges[] = {0, 1, 3, 1U << 30U};

KernelCase draw_lattice(const std::string& name, Random& random) {
  const WindowSize window = draw_window(random);
  return lattice_case(name, window, draw_from(random, kPriors));
}
KernelCase draw_minima(const std::string& name, Random& random) {
  const WindowSize window = draw_window(random);
  return minima_case(name, window, draw_count(random, 1U << 31U));
}
KernelCase draw_smallest(const std::string& name, Random& random) {
  const std::uint32_t count = draw_count(random, 100000);
  const auto wanted = static_cast<std::uint32_t>(1 + random.below(SmallestValues::kMost));
  return smallest_case(name, count, wanted, draw_count(random, 1U << 31U));
}

void add_lattices(std::vector<KernelCaseSource>& list) {
  for (const WindowSize& window : kWindows) {
    for (const PriorKind kind : kPriors) {
      add_lattice(list, window, kind);
    }
  }
  for_each_small_window(
      [&](WindowSize window, std::uint32_t turn) { add_lattice(list, window, in_turn(kPriors, turn)); });
  for (const PriorKind kind : {PriorKind::kWeak, PriorKind::kSubnormal}) {
    for (const float step : {1.0F, 1.0e-22F, 1.0e-37F}) {
      const std::string steps = step == 1.0F ? "1" : step == 1.0e-22F ? "1e-22" : "1e-37";
      add_case<PoseLattice>(list, "subnormal mean, steps of " + steps + ", " + std::string(to_string(kind)),
                            [=](const std::string& name) {
                              return subnormal_lattice(name, {9, 5}, step, kind);
                            });
    }
  }
  add_large_case<PoseLattice>(list, kLargeWindow.name(), [](const std::string& name) {
    return lattice_case(name, kLargeWindow, PriorKind::kWeak);
  });
  add_lattice(list, kBenchWindow, PriorKind::kWeak, true);
}

void add_window_minima(std::vector<KernelCaseSource>& list) {
  for (const WindowSize& window : kWindows) {
    for (const std::uint32_t range : kRanges) {
      add_minima(list, window, range);
    }
    add_corner_minima(list, window);
  }
  for_each_small_window([&](WindowSize window, std::uint32_t turn) {
    add_minima(list, window, in_turn(kRanges, turn));
    add_minima(list, window, in_turn(kRanges, turn + 2));
  });
  add_large_case<LatticeMinima>(list, kLargeWindow.name(),
                                [](const std::string& name) { return minima_case(name, kLargeWindow, 1U << 12U); });
  add_minima(list, kBenchWindow, 1U << 20U, true);
}

void add_smallest_lists(std::vector<KernelCaseSource>& list) {
  for (const std::uint32_t count : {0U, 1U, 2U, 15U, 16U, 17U, 63U, 64U, 65U, 255U, 1000U, 70001U}) {
    for (const std::uint32_t wanted : {1U, 2U, 8U, 16U}) {
      for (const std::uint32_t range : kRanges) {
        add_smallest(list, count, wanted, range);
      }
      add_falling(list, count, wanted, 1);
      add_falling(list, count, wanted, 64);
    }
  }
  // The least value is the last one, at every place of a block that an invocation of a group of some size takes at
  // once.
  for (const auto& [group, wanted] : {std::pair{8U, 3U}, std::pair{128U, 4U}, std::pair{1024U, 5U}}) {
    for (std::uint32_t place = 1; place < SmallestValues::kMost; ++place) {
      add_falling(list, group * place + 1, wanted, 1);
    }
  }
  for (std::uint32_t count = 18; count < 63; ++count) {
    add_smallest(list, count, 1 + count % SmallestValues::kMost,
                 in_turn(kRanges, count + count / SmallestValues::kMost));
  }
  add_large_case<SmallestValues>(list, "16 among 16777259",
                                 [](const std::string& name) { return smallest_case(name, 16777259, 16, 1U << 31U); });
  add_smallest(list, kBenchWindow.samples(), 8, 1U << 30U, true);
}

}  // namespace

void add_lattice_cases(std::vector<KernelCaseSource>& list) {
  add_lattices(list);
  add_window_minima(list);
  add_smallest_lists(list);
}

void add_lattice_draws(std::vector<RandomKernel>& list) {
  list.push_back({&PoseLattice::info(), draw_lattice});
  list.push_back({&LatticeMinima::info(), draw_minima});
  list.push_back({&SmallestValues::info(), draw_smallest});
}

}  // namespace gdtslam
