#include "cases/case_builder.hpp"
#include "gdtslam/compute/kernels/pose_cost.hpp"
#include "gdtslam/compute/kernels/pose_lattice.hpp"

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

constexpr WindowSize kWindows[] = {{1, 1},  {1, 2},  {1, 7},  {1, 100}, {2, 1},  {2, 2},   {3, 1},
                                   {3, 3},  {4, 5},  {5, 2},  {8, 8},   {9, 13}, {16, 3},  {17, 4},
                                   {31, 7}, {64, 2}, {65, 3}, {101, 2}, {97, 5}, {257, 1}, {300, 2}};
constexpr WindowSize kBenchWindow{101, 41};  // +-1 m in steps of 2 cm, +-10 degrees in steps of half a degree

/// Priors: none, one as a scan has it, one that is at its limit everywhere but near the mean.
enum class PriorKind : std::uint8_t { kNone, kWeak, kSteep };

std::string_view name_of(PriorKind kind) {
  return kind == PriorKind::kNone ? "no prior" : kind == PriorKind::kWeak ? "weak prior" : "steep prior";
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
  }
  return prior;
}

void add_lattice(std::vector<KernelCaseSource>& list, WindowSize window, PriorKind kind, bool benchmark) {
  add_case<PoseLattice>(
      list, window.name() + " " + std::string(name_of(kind)),
      [=](const std::string& named) {
        Random random(seed_from(named));
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
        return make_case<PoseLattice>(named, params, {window.samples(), 1, 1},
                                      {list_buffer(noise<std::uint32_t>({words, 1, words}, random.bits()))});
      },
      benchmark);
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

void add_minima(std::vector<KernelCaseSource>& list, WindowSize window, std::uint32_t range, bool benchmark) {
  add_case<LatticeMinima>(
      list, window.name() + range_name(range),
      [=](const std::string& named) {
        Random random(seed_from(named));
        const std::uint32_t count = window.samples();
        std::vector<std::uint32_t> costs = window_costs(count, range, random);
        if (range == 1) {
          costs.assign(count, 7);
        }
        return make_case<LatticeMinima>(
            named, {window.xy, window.theta}, {count, 1, 1},
            {list_buffer(costs), list_buffer(noise<std::uint32_t>({count, 1, count}, random.bits()))});
      },
      benchmark);
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

void add_smallest(std::vector<KernelCaseSource>& list, std::uint32_t count, std::uint32_t wanted, std::uint32_t range,
                  bool benchmark) {
  add_case<SmallestValues>(
      list, std::to_string(wanted) + " among " + std::to_string(count) + range_name(range),
      [=](const std::string& named) {
        Random random(seed_from(named));
        return make_case<SmallestValues>(
            named, {count, wanted}, {1, 1, 1},
            {list_buffer(window_costs(count, range, random)),
             list_buffer(noise<std::uint32_t>({2 * wanted, 1, 2 * wanted}, random.bits()))});
      },
      benchmark);
}

/// Values that fall all the way, so that each enters the list; every fourth is kNoCost.
void add_falling(std::vector<KernelCaseSource>& list, std::uint32_t count, std::uint32_t wanted) {
  add_case<SmallestValues>(
      list, std::to_string(wanted) + " among " + std::to_string(count) + " falling", [=](const std::string& named) {
        std::vector<std::uint32_t> values(count);
        for (std::uint32_t i = 0; i < count; ++i) {
          values[i] = i % 4 == 3 ? kNoCost : kNoCost - 1 - i;
        }
        return make_case<SmallestValues>(named, {count, wanted}, {1, 1, 1},
                                         {list_buffer(values), list_buffer(std::vector<std::uint32_t>(2 * wanted, 9))});
      });
}

}  // namespace

void add_lattice_cases(std::vector<KernelCaseSource>& list) {
  for (const WindowSize& window : kWindows) {
    for (const PriorKind kind : {PriorKind::kNone, PriorKind::kWeak, PriorKind::kSteep}) {
      add_lattice(list, window, kind, false);
    }
  }
  add_lattice(list, kBenchWindow, PriorKind::kWeak, true);
  for (const WindowSize& window : kWindows) {
    for (const std::uint32_t range : {0U, 1U, 3U, 1U << 30U}) {
      add_minima(list, window, range, false);
    }
    add_corner_minima(list, window);
  }
  add_minima(list, kBenchWindow, 1U << 20U, true);
  for (const std::uint32_t count : {0U, 1U, 2U, 15U, 16U, 17U, 63U, 64U, 65U, 255U, 1000U, 70001U}) {
    for (const std::uint32_t wanted : {1U, 2U, 8U, 16U}) {
      for (const std::uint32_t range : {0U, 1U, 3U, 1U << 30U}) {
        add_smallest(list, count, wanted, range, false);
      }
      add_falling(list, count, wanted);
    }
  }
  add_smallest(list, kBenchWindow.samples(), 8, 1U << 30U, true);
}

}  // namespace gdtslam
