#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"
#include "nelder_mead.hpp"
#include "simplex_moves.hpp"

namespace gdtslam::optimize {
namespace {

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
    function_.evaluate(vertices_);
    temperature_ = first_temperature();
    first_temperature_ = temperature_;
  }

  void run() {
    const std::uint64_t moves = std::uint64_t{method_.moves_per_dimension} * function_.dimensions();
    while (!function_.must_stop() && !is_cold() && !is_small()) {
      Spread spread;
      for (std::uint64_t k = 0; k < moves && !function_.must_stop(); ++k) move(spread);
      cool(spread.deviation());
    }
  }

 private:
  // Where the mean rise between two random points of the box is accepted with the asked probability.
  double first_temperature() {
    std::vector<Valued> sample(10 * function_.dimensions());
    for (Valued& one : sample) one.point = random_point();
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

  Point random_point() {
    Point point(function_.dimensions());
    for (std::size_t k = 0; k < point.size(); ++k) {
      point[k] = random_.uniform(function_.box().least[k], function_.box().most[k]);
    }
    return function_.clamped(std::move(point));
  }

  // -T ln(u), the disturbance of [Press1991]: added to what is there, taken off what is tried.
  double heat() { return temperature_ * -log(1.0 - random_.uniform()); }

  Valued tried(const Point& centre, const Point& worst, double factor, Spread& spread) {
    Valued one{along(centre, worst, factor), 0.0};
    if (!function_.holds(one.point)) one.point = random_point();
    one.value = function_.evaluate(one.point);
    spread.add(one.value);
    return one;
  }

  // One move of Nelder and Mead on values that are disturbed anew each time.
  void move(Spread& spread) {
    std::vector<std::pair<double, std::size_t>> order;
    order.reserve(vertices_.size());
    for (std::size_t i = 0; i < vertices_.size(); ++i) order.emplace_back(vertices_[i].value + heat(), i);
    std::sort(order.begin(), order.end());
    std::vector<Valued> sorted;
    sorted.reserve(vertices_.size());
    for (const auto& [warm, i] : order) sorted.push_back(vertices_[i]);
    vertices_ = std::move(sorted);
    const double best = order.front().first;
    const double second_worst = order[order.size() - 2].first;
    const double worst = order.back().first;

    const Point centre = centre_of(vertices_);
    const Point from = vertices_.back().point;
    const Valued reflected = tried(centre, from, -1.0, spread);
    const double warm_reflected = reflected.value - heat();
    if (warm_reflected < best) {
      const Valued expanded = tried(centre, from, -2.0, spread);
      vertices_.back() = expanded.value - heat() < warm_reflected ? expanded : reflected;
    } else if (warm_reflected < second_worst) {
      vertices_.back() = reflected;
    } else {
      const bool is_outside = warm_reflected < worst;
      const Valued contracted = tried(centre, from, is_outside ? -0.5 : 0.5, spread);
      if (contracted.value - heat() < std::min(worst, warm_reflected)) {
        vertices_.back() = contracted;
      } else {
        shrink(function_, vertices_);
        for (const Valued& vertex : vertices_) spread.add(vertex.value);
      }
    }
  }

  // T' = T / (1 + T ln(1 + delta) / (3 sigma)) [Aarts1985].
  void cool(double deviation) {
    temperature_ =
        deviation > 0.0 ? temperature_ / (1.0 + temperature_ * log(1.0 + method_.cooling) / (3.0 * deviation)) : 0.0;
  }

  [[nodiscard]] bool is_cold() const { return !(temperature_ > 1e-9 * first_temperature_); }

  [[nodiscard]] bool is_small() const {
    for (std::size_t k = 0; k < function_.dimensions(); ++k) {
      if (extent(vertices_, k) > method_.tolerance * function_.width(k)) return false;
    }
    return true;
  }

  Counted& function_;
  const SimplexAnnealing& method_;
  Random random_;
  std::vector<Valued> vertices_;
  double temperature_ = 0.0;
  double first_temperature_ = 0.0;
};

}  // namespace

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
  if (!counted.must_stop()) {
    std::vector<Valued> vertices = first_simplex(counted, counted.best().point, last.steps);
    counted.evaluate(vertices);
    descend(counted, vertices, last);
  }
  return counted.result();
}

}  // namespace gdtslam::optimize
