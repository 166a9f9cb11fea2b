// The simplex of Nelder and Mead, plain and annealed: both move by the same rules, the annealed one on values that are
// disturbed anew each time.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "counted.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::optimize {
namespace {

/// Differences between the plain method and the annealed one.
struct SimplexRule {
  std::function<void(Valued&)> evaluate;  ///< values a point that is tried, which may lie beyond the box
  std::function<double()> heat;           ///< added to what is there, taken off what is tried
};

/// A start and one vertex along each dimension, turned inwards where the step would leave the box; valued.
std::vector<Valued> first_simplex(Counted& function, const Point& start, std::span<const double> steps) {
  std::vector<Valued> vertices(start.size() + 1, Valued{start, 0.0});
  for (std::size_t k = 0; k < start.size(); ++k) {
    const double step = steps.empty() ? 0.1 * function.width(k) : steps[k];
    double& coordinate = vertices[k + 1].point[k];
    coordinate += coordinate + step <= function.box().most[k] ? step : -step;
    vertices[k + 1].point = function.clamped(vertices[k + 1].point);
  }
  function.evaluate(vertices);
  return vertices;
}

/// Sorts the vertices by their disturbed values, which it returns.
std::vector<double> sort_vertices(std::vector<Valued>& vertices, const SimplexRule& rule) {
  std::vector<std::pair<double, std::size_t>> order;
  order.reserve(vertices.size());
  for (const Valued& vertex : vertices) order.emplace_back(vertex.value + rule.heat(), order.size());
  std::sort(order.begin(), order.end());
  std::vector<Valued> sorted;
  std::vector<double> values;
  for (const auto& [value, i] : order) {
    sorted.push_back(std::move(vertices[i]));
    values.push_back(value);
  }
  vertices = std::move(sorted);
  return values;
}

// One move: the worst vertex is replaced, or all but the best are drawn half way to it, which returns true. Where a
// limit is met on the way, it ends there.
bool move(Counted& function, std::vector<Valued>& vertices, const SimplexRule& rule) {
  const std::vector<double> values = sort_vertices(vertices, rule);
  const Point centre = centroid(vertices);
  const Point from = vertices.back().point;
  const auto tried = [&](double factor) {
    Valued one{along(centre, from, factor), 0.0};
    rule.evaluate(one);
    return one;
  };
  const Valued reflected = tried(-1.0);
  const double reflected_value = reflected.value - rule.heat();
  if (function.must_stop()) return false;  // whose best point is kept
  if (reflected_value < values.front()) {
    const Valued expanded = tried(-2.0);
    vertices.back() = expanded.value - rule.heat() < reflected_value ? expanded : reflected;
    return false;
  }
  if (reflected_value < values[values.size() - 2]) {
    vertices.back() = reflected;
    return false;
  }
  const Valued contracted = tried(reflected_value < values.back() ? -0.5 : 0.5);
  if (contracted.value - rule.heat() < std::min(values.back(), reflected_value)) {
    vertices.back() = contracted;
    return false;
  }
  if (function.must_stop()) return false;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    vertices[i].point = along(vertices.front().point, vertices[i].point, 0.5);
  }
  function.evaluate(std::span(vertices).subspan(1));
  return true;
}

// Until the simplex is smaller than the tolerances or a limit is met.
void descend(Counted& function, const Point& start, const NelderMead& method) {
  std::vector<Valued> vertices = first_simplex(function, start, method.steps);
  const auto is_small = [&] {
    if (method.tolerances.empty()) return function.is_small(vertices, 1e-6);
    for (std::size_t k = 0; k < function.dimensions(); ++k) {
      if (extent(vertices, k) > method.tolerances[k]) return false;
    }
    return true;
  };
  // Beyond the box a point is worth nothing and is not valued. Drawing it onto a face would flatten the simplex there.
  const auto evaluate = [&function](Valued& one) {
    one.value = function.holds(one.point) ? function.evaluate(one.point) : std::numeric_limits<double>::infinity();
  };
  while (!function.must_stop() && !is_small()) move(function, vertices, {evaluate, [] { return 0.0; }});
}

/// Running mean and spread of the values met at one temperature.
class Spread {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    ++count_;
    const double step = value - mean_;
    mean_ += step / static_cast<double>(count_);
    sum_sq_ += step * (value - mean_);
  }
  [[nodiscard]] double deviation() const {
    return count_ > 1 ? std::sqrt(sum_sq_ / static_cast<double>(count_ - 1)) : 0.0;
  }

 private:
  std::uint64_t count_ = 0;
  double mean_ = 0.0;
  double sum_sq_ = 0.0;
};

class Annealing {
 public:
  Annealing(Counted& function, const SimplexAnnealing& method)
      : function_(function), method_(method), random_(method.seed) {
    vertices_ = first_simplex(function_, function_.start(), {});
    if (function_.must_stop()) return;
    temperature_ = first_temperature();
    first_temperature_ = temperature_;
  }

  void run() {
    const std::uint64_t moves = std::uint64_t{method_.moves_per_dimension} * function_.dimensions();
    while (!function_.must_stop() && !is_cold() && !function_.is_small(vertices_, method_.tolerance)) {
      Spread spread;
      for (std::uint64_t k = 0; k < moves && !function_.must_stop(); ++k) move_once(spread);
      cool(spread.deviation());
    }
  }

 private:
  // Temperature at which the mean rise between two random points of the box is accepted with the asked probability.
  double first_temperature() {
    std::vector<Valued> sample(10 * function_.dimensions());
    for (Valued& one : sample) one.point = function_.random_point(random_);
    function_.evaluate(sample);
    double rise = 0.0;
    std::uint64_t rises = 0;
    for (std::size_t i = 1; i < sample.size(); ++i) {
      const double step = std::abs(sample[i].value - sample[i - 1].value);
      if (step > 0.0 && std::isfinite(step)) {
        rise += step;
        ++rises;
      }
    }
    return rises == 0 ? 0.0 : rise / static_cast<double>(rises) / -log(method_.first_acceptance);
  }

  void move_once(Spread& spread) {
    const auto evaluate = [this, &spread](Valued& one) {
      if (!function_.holds(one.point)) one.point = function_.random_point(random_);
      one.value = function_.evaluate(one.point);
      spread.add(one.value);
    };
    // -T ln(u), the disturbance of [Press1991].
    const auto heat = [this] { return temperature_ * -log(1.0 - random_.uniform()); };
    if (!move(function_, vertices_, {evaluate, heat})) return;
    for (const Valued& vertex : vertices_) spread.add(vertex.value);
  }

  // T' = T / (1 + T ln(1 + delta) / (3 sigma)) [Aarts1985].
  void cool(double deviation) {
    temperature_ =
        deviation > 0.0 ? temperature_ / (1.0 + temperature_ * log(1.0 + method_.cooling) / (3.0 * deviation)) : 0.0;
  }

  [[nodiscard]] bool is_cold() const { return !(temperature_ > 1e-9 * first_temperature_); }

  Counted& function_;
  const SimplexAnnealing& method_;
  Random random_;
  std::vector<Valued> vertices_;
  double temperature_ = 0.0;
  double first_temperature_ = 0.0;
};

}  // namespace

Minimum minimise(Function& function, const Box& box, std::span<const double> start, const NelderMead& method,
                 const Limits& limits) {
  Counted counted(function, box, start, limits);
  for (const std::vector<double>* given : {&method.steps, &method.tolerances}) {
    if (!given->empty() && given->size() != start.size())
      throw ConfigError("minimise: one step and tolerance a dimension");
  }
  descend(counted, counted.start(), method);
  return counted.result();
}

Minimum minimise(Function& function, const Box& box, std::span<const double> start, const SimplexAnnealing& method,
                 const Limits& limits) {
  if (!(method.first_acceptance > 0.0 && method.first_acceptance < 1.0) || !(method.cooling > 0.0) ||
      method.moves_per_dimension == 0) {
    throw ConfigError(
        "minimise: first_acceptance lies between 0 and 1, cooling is positive, moves_per_dimension not 0");
  }
  Counted counted(function, box, start, limits);
  Annealing(counted, method).run();
  NelderMead last;
  for (std::size_t k = 0; k < start.size(); ++k) {
    last.steps.push_back(0.01 * counted.width(k));
    last.tolerances.push_back(method.tolerance * counted.width(k));
  }
  if (!counted.must_stop()) descend(counted, counted.best().point, last);
  return counted.result();
}

}  // namespace gdtslam::optimize
