#include "counted.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "gdtslam/core/error.hpp"

namespace gdtslam::optimize {
namespace {

constexpr double kWorst = std::numeric_limits<double>::infinity();

}  // namespace

Counted::Counted(Function& function, const Box& box, std::span<const double> start, const Limits& limits)
    : function_(&function), box_(&box), limits_(limits), start_(start.begin(), start.end()) {
  const std::size_t n = function.dimensions();
  if (n == 0 || box.least.size() != n || box.most.size() != n || start.size() != n) {
    throw ConfigError("minimise: box and start must have the function's number of dimensions, at least one");
  }
  for (std::size_t k = 0; k < n; ++k) {
    if (!(box.least[k] < box.most[k])) throw ConfigError("minimise: the box is empty");
  }
  start_ = clamped(start_);
  best_ = {start_, kWorst};
}

void Counted::evaluate(std::span<Valued> batch) {
  const std::size_t n = dimensions();
  points_.resize(batch.size() * n);
  values_.resize(batch.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    std::copy(batch[i].point.begin(), batch[i].point.end(), points_.begin() + static_cast<std::ptrdiff_t>(i * n));
  }
  function_->evaluate(points_, values_);
  evaluations_ += batch.size();
  for (std::size_t i = 0; i < batch.size(); ++i) {
    batch[i].value = std::isnan(values_[i]) ? kWorst : values_[i];
    if (is_better(batch[i], best_)) best_ = batch[i];
  }
}

double Counted::evaluate(const Point& point) {
  Valued one{point, kWorst};
  evaluate({&one, 1});
  return one.value;
}

// Not a number, from a flat swarm or an infinite value, lands on the lower face.
Point Counted::clamped(Point point) const {
  for (std::size_t k = 0; k < point.size(); ++k) {
    point[k] = point[k] > box_->least[k] ? std::min(point[k], box_->most[k]) : box_->least[k];
  }
  return point;
}

bool Counted::holds(const Point& point) const {
  for (std::size_t k = 0; k < point.size(); ++k) {
    if (!(point[k] >= box_->least[k] && point[k] <= box_->most[k])) return false;
  }
  return true;
}

Point Counted::random_point(Random& random) const {
  return clamped(optimize::random_point(box_->least, box_->most, random));
}

bool Counted::is_small(std::span<const Valued> points, double share) const {
  for (std::size_t k = 0; k < dimensions(); ++k) {
    if (extent(points, k) > share * width(k)) return false;
  }
  return true;
}

bool Counted::must_stop() const { return evaluations_ >= limits_.max_evaluations || best_.value <= limits_.target; }

Minimum Counted::result() const {
  const Stop stop = best_.value <= limits_.target             ? Stop::kTarget
                    : evaluations_ >= limits_.max_evaluations ? Stop::kEvaluations
                                                              : Stop::kConverged;
  return {best_.point, best_.value, evaluations_, stop};
}

double extent(std::span<const Valued> points, std::size_t k) {
  double least = kWorst;
  double most = -kWorst;
  for (const Valued& one : points) {
    least = std::min(least, one.point[k]);
    most = std::max(most, one.point[k]);
  }
  return most - least;
}

Point random_point(const Point& least, const Point& most, Random& random) {
  Point point(least.size());
  for (std::size_t k = 0; k < point.size(); ++k) point[k] = random.uniform(least[k], most[k]);
  return point;
}

Point centroid(std::span<const Valued> points) {
  const std::size_t n = points.size() - 1;
  Point centre(points.front().point.size(), 0.0);
  for (std::size_t k = 0; k < centre.size(); ++k) {
    for (std::size_t i = 0; i < n; ++i) centre[k] += points[i].point[k];
    centre[k] /= static_cast<double>(n);
  }
  return centre;
}

Point along(const Point& centre, const Point& worst, double factor) {
  Point point(centre.size());
  for (std::size_t k = 0; k < point.size(); ++k) point[k] = centre[k] + factor * (worst[k] - centre[k]);
  return point;
}

std::string_view to_string(Stop stop) {
  switch (stop) {
    case Stop::kConverged:
      return "converged";
    case Stop::kEvaluations:
      return "evaluation limit";
    case Stop::kTarget:
      return "target reached";
  }
  return "";
}

}  // namespace gdtslam::optimize
