// A function whose points are counted and whose best point is kept: what all methods share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/optimize/minimise.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam::optimize {

using Point = std::vector<double>;

/// A point with its value.
struct Valued {
  Point point;
  double value = 0.0;
};
inline bool is_better(const Valued& a, const Valued& b) { return a.value < b.value; }

class Counted {
 public:
  /// Throws ConfigError where box or start do not fit the function, or the box is empty.
  Counted(Function& function, const Box& box, std::span<const double> start, const Limits& limits);

  /// Values all points in one batch; each must lie in the box. NaN becomes infinity.
  void evaluate(std::span<Valued> batch);
  double evaluate(const Point& point);

  /// Nearest point of the box.
  [[nodiscard]] Point clamped(Point point) const;
  [[nodiscard]] bool holds(const Point& point) const;
  /// Evenly at random in the box.
  [[nodiscard]] Point random_point(Random& random) const;
  /// Whether the points are, in each dimension, no further apart than this share of the box.
  [[nodiscard]] bool is_small(std::span<const Valued> points, double share) const;
  [[nodiscard]] double width(std::size_t k) const { return box_->most[k] - box_->least[k]; }
  [[nodiscard]] const Box& box() const { return *box_; }
  [[nodiscard]] const Point& start() const { return start_; }
  [[nodiscard]] std::size_t dimensions() const { return start_.size(); }

  /// True when a limit says that no further batch may be valued.
  [[nodiscard]] bool must_stop() const;
  /// The best point seen, and why it ended: a limit where one was met, else converged.
  [[nodiscard]] Minimum result() const;
  [[nodiscard]] const Valued& best() const { return best_; }

 private:
  Function* function_;
  const Box* box_;
  Limits limits_;
  Point start_;
  Valued best_;
  std::uint64_t evaluations_ = 0;
  std::vector<double> points_;
  std::vector<double> values_;
};

/// Largest extent of the points in dimension k.
double extent(std::span<const Valued> points, std::size_t k);
/// Evenly at random between two corners.
Point random_point(const Point& least, const Point& most, Random& random);
/// Centre of all points but the last.
Point centroid(std::span<const Valued> points);
/// centre + factor * (worst - centre): -1 reflects, -2 expands, 1/2 and -1/2 contract.
Point along(const Point& centre, const Point& worst, double factor);

}  // namespace gdtslam::optimize
