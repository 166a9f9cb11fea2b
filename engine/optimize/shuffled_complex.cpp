#include <algorithm>
#include <cmath>
#include <deque>

#include "counted.hpp"
#include "engine/core/elementary.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::optimize {
namespace {

struct Complex {
  std::vector<Valued> points;  ///< sorted, the best first
  Random random;
};

/// The step of one complex: which of its points form the sub-complex, the best first, and the centre of all but the
/// worst of them.
struct Step {
  std::vector<std::size_t> members;
  Point centre;
  bool is_done = false;
};

// Within the smallest box that holds the complex.
Point mutated(const Counted& function, Complex& complex) {
  Point least = complex.points.front().point;
  Point most = least;
  for (const Valued& one : complex.points) {
    for (std::size_t k = 0; k < least.size(); ++k) {
      least[k] = std::min(least[k], one.point[k]);
      most[k] = std::max(most[k], one.point[k]);
    }
  }
  return function.clamped(random_point(least, most, complex.random));
}

// Distinct members by the trapezoidal probability 2 (m + 1 - i) / (m (m + 1)), i from 1 for the best.
std::vector<std::size_t> choose_members(Complex& complex, std::size_t count) {
  const std::size_t m = complex.points.size();
  std::vector<std::size_t> members;
  while (members.size() < count) {
    std::uint64_t ticket = complex.random.below(m * (m + 1) / 2);
    std::size_t i = 0;
    while (ticket >= m - i) {
      ticket -= m - i;
      ++i;
    }
    if (std::find(members.begin(), members.end(), i) == members.end()) members.push_back(i);
  }
  std::sort(members.begin(), members.end());
  return members;
}

Step begin_step(Complex& complex, std::size_t count) {
  Step step{choose_members(complex, count), {}, false};
  std::vector<Valued> chosen;
  for (const std::size_t member : step.members) chosen.push_back(complex.points[member]);
  step.centre = centroid(chosen);
  return step;
}

class Population {
 public:
  Population(Counted& function, const ShuffledComplex& method) : function_(function), random_(method.seed) {
    const std::size_t m = 2 * function.dimensions() + 1;
    points_.push_back({function.start(), 0.0});
    while (points_.size() < method.complexes * m) {
      points_.push_back({function.random_point(random_), 0.0});
    }
    function_.evaluate(points_);
    for (std::size_t c = 0; c < method.complexes; ++c) complexes_.push_back({{}, random_.split(c + 1)});
    std::stable_sort(points_.begin(), points_.end(), is_better);
  }

  // Deals the points out, evolves each complex 2n + 1 times, and shuffles.
  void evolve() {
    const std::size_t p = complexes_.size();
    for (Complex& complex : complexes_) complex.points.clear();
    for (std::size_t i = 0; i < points_.size(); ++i) complexes_[i % p].points.push_back(points_[i]);
    for (std::size_t k = 0; k < 2 * function_.dimensions() + 1 && !function_.must_stop(); ++k) evolve_once();
    points_.clear();
    for (const Complex& complex : complexes_) {
      points_.insert(points_.end(), complex.points.begin(), complex.points.end());
    }
    std::stable_sort(points_.begin(), points_.end(), is_better);
  }

  // Geometric mean of the extents as shares of the box.
  [[nodiscard]] double size() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < function_.dimensions(); ++k) {
      const double share = extent(points_, k) / function_.width(k);
      if (share <= 0.0) return 0.0;
      sum += log(share);
    }
    return exp(sum / static_cast<double>(function_.dimensions()));
  }

  [[nodiscard]] double best() const { return points_.front().value; }

 private:
  // One step of every complex, side by side: reflections in one batch, then contractions where a reflection was not
  // better, then random points where that was not either, which are taken whatever they are worth.
  void evolve_once() {
    std::vector<Step> steps;
    for (Complex& complex : complexes_) steps.push_back(begin_step(complex, function_.dimensions() + 1));
    try_points(steps, false, [this](Complex& complex, const Step& step, const Point& worst) {
      Point point = along(step.centre, worst, -1.0);
      return function_.holds(point) ? point : mutated(function_, complex);
    });
    try_points(steps, false,
               [](Complex&, const Step& step, const Point& worst) { return along(step.centre, worst, 0.5); });
    try_points(steps, true,
               [this](Complex& complex, const Step&, const Point&) { return mutated(function_, complex); });
    for (Complex& complex : complexes_) std::stable_sort(complex.points.begin(), complex.points.end(), is_better);
  }

  template <class Proposal>
  void try_points(std::vector<Step>& steps, bool is_forced, const Proposal& propose) {
    if (function_.must_stop()) return;
    std::vector<Valued> batch;
    for (std::size_t c = 0; c < steps.size(); ++c) {
      if (steps[c].is_done) continue;
      batch.push_back({propose(complexes_[c], steps[c], complexes_[c].points[steps[c].members.back()].point), 0.0});
    }
    if (batch.empty()) return;
    function_.evaluate(batch);
    std::size_t next = 0;
    for (std::size_t c = 0; c < steps.size(); ++c) {
      if (steps[c].is_done) continue;
      Valued& worst = complexes_[c].points[steps[c].members.back()];
      const Valued& tried = batch[next++];
      if (is_forced || is_better(tried, worst)) {
        worst = tried;
        steps[c].is_done = true;
      }
    }
  }

  Counted& function_;
  Random random_;
  std::vector<Valued> points_;  ///< sorted between two shuffles
  std::vector<Complex> complexes_;
};

}  // namespace

Minimum minimise(Function& function, const Box& box, std::span<const double> start, const ShuffledComplex& method,
                 const Limits& limits) {
  if (method.complexes == 0 || method.loops == 0) throw ConfigError("minimise: at least one complex and one loop");
  Counted counted(function, box, start, limits);
  Population population(counted, method);
  std::deque<double> bests{population.best()};
  while (!counted.must_stop() && population.size() > method.tolerance) {
    population.evolve();
    bests.push_back(population.best());
    if (bests.size() <= method.loops) continue;
    const double mean = 0.5 * (std::abs(bests.front()) + std::abs(bests.back()));
    if (bests.front() - bests.back() <= method.improvement * mean) break;
    bests.pop_front();
  }
  return counted.result();
}

}  // namespace gdtslam::optimize
