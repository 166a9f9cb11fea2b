#include "matchers.hpp"

#include <algorithm>
#include <array>

#include "scan_matcher.hpp"

namespace gdtslam {
namespace {

LocalMinimum by_simplex(Objective& objective, const CellPose& start, const SimplexOptions& steps,
                        const OptimizerConfig& /*options*/) {
  return minimise_simplex(objective, start, steps);
}

template <MatcherKind kKind>
LocalMinimum in_box(Objective& objective, const CellPose& start, const SimplexOptions& steps,
                    const OptimizerConfig& options) {
  return minimise_in_box(objective, start,
                         {.half_cells = kBoxSteps * steps.step_cells,
                          .half_rad = kBoxSteps * steps.step_rad,
                          .stop_cells = steps.stop_cells,
                          .stop_rad = steps.stop_rad},
                         kKind, options);
}

using Descent = decltype(MatcherInfo::descend);

constexpr MatcherInfo walker(MatcherKind kind, std::string_view name, std::string_view doc, Descent descend) {
  return {.kind = kind,
          .name = name,
          .doc = doc,
          .descend = descend,
          .follows_slope = descend == nullptr,
          .always_searches = kind == MatcherKind::kExhaustive,
          .proves_windows = kind == MatcherKind::kCertified};
}

constexpr std::array kMatchers{
    walker(MatcherKind::kSimplex, "simplex", "downhill simplex", by_simplex),
    walker(MatcherKind::kPso, "pso", "particle swarm", in_box<MatcherKind::kPso>),
    walker(MatcherKind::kSce, "sce", "shuffled complexes", in_box<MatcherKind::kSce>),
    walker(MatcherKind::kSimpsa, "simpsa", "annealed simplex", in_box<MatcherKind::kSimpsa>),
    walker(MatcherKind::kGaussNewton, "gauss-newton", "robust least squares", nullptr),
    walker(MatcherKind::kExhaustive, "exhaustive", "robust least squares, a window for each scan", nullptr),
    walker(MatcherKind::kCertified, "certified", "simplex with windows whose best pose is proven", by_simplex),
};

constexpr bool is_in_order() {
  for (std::size_t k = 0; k < kMatchers.size(); ++k) {
    if (static_cast<std::size_t>(kMatchers[k].kind) != k) return false;
  }
  return true;
}
static_assert(is_in_order());

constexpr auto kMatcherNames = [] {
  std::array<std::string_view, kMatchers.size()> names;
  std::transform(kMatchers.begin(), kMatchers.end(), names.begin(), [](const MatcherInfo& row) { return row.name; });
  return names;
}();

}  // namespace

std::span<const MatcherInfo> matchers() { return kMatchers; }

const MatcherInfo& matcher_info(MatcherKind kind) { return kMatchers.at(static_cast<std::size_t>(kind)); }

std::string_view to_string(MatcherKind kind) { return matcher_info(kind).name; }

std::span<const std::string_view> matcher_names() { return kMatcherNames; }

}  // namespace gdtslam
