// Minimisers without derivatives over a box of R^n: the four that the paper compares, each from the paper that
// introduced it, with that paper's parameters as defaults. They see the function as a batch of points to be valued, so
// that whatever can be valued at once goes to the device at once; own random numbers, no function of the C library, so
// the same seed gives the same bits on every host. One call belongs to one thread. Each throws ConfigError for an empty
// box, a start or options that do not fit the function's dimensions, and parameters out of range.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gdtslam::optimize {

/// A function of n numbers; smaller is better. NaN counts as worse than any number.
class Function {
 public:
  Function() = default;
  Function(const Function&) = delete;
  Function& operator=(const Function&) = delete;
  virtual ~Function() = default;
  [[nodiscard]] virtual std::size_t dimensions() const = 0;
  /// `points` holds values.size() points, one after the other.
  virtual void evaluate(std::span<const double> points, std::span<double> values) = 0;
};

/// Region of the search; points outside are never valued.
struct Box {
  std::vector<double> least;
  std::vector<double> most;
};

/// Why a method stopped.
enum class Stop : std::uint8_t {
  kConverged,    ///< the method's own criterion
  kEvaluations,  ///< the limit of evaluations
  kTarget,       ///< a value at or below the target was found
};

/// Limits that end every method besides its own criterion; looked at before each batch.
struct Limits {
  std::uint64_t max_evaluations = 100000;
  double target = -1e300;
};

/// Point where a method stopped, and its cost.
struct Minimum {
  std::vector<double> point;
  double value = 0.0;
  std::uint64_t evaluations = 0;
  Stop stop = Stop::kEvaluations;
};

/// Downhill simplex of Nelder and Mead [Nelder1965]: reflection 1, expansion 2, contraction and shrinking 1/2. Points
/// beyond the box are worth nothing. Batches: the first simplex, and a shrinking.
struct NelderMead {
  std::vector<double> steps;  ///< edges of the first simplex; empty: a tenth of the box
  std::vector<double>
      tolerances;  ///< converged when the simplex is smaller than this in each dimension; empty: 1e-6 of the box
};
Minimum minimise(Function& function, const Box& box, std::span<const double> start, const NelderMead& method,
                 const Limits& limits);

/// Particle swarm with Clerc's constriction factor [Clerc2002], global best. Batches: a generation.
struct ParticleSwarm {
  std::size_t particles = 30;
  double phi_1 = 2.05;      ///< pull to the particle's own best
  double phi_2 = 2.05;      ///< and to the swarm's; phi_1 + phi_2 > 4
  double tolerance = 1e-6;  ///< converged when the swarm is smaller than this share of the box in each dimension ...
  std::uint32_t patience = 10;  ///< ... for so many generations
  std::uint64_t seed = 1;
};
Minimum minimise(Function& function, const Box& box, std::span<const double> start, const ParticleSwarm& method,
                 const Limits& limits);

/// Shuffled complex evolution, SCE-UA [Duan1992, Duan1994]: p complexes of 2n + 1 points, sub-complexes of n + 1,
/// each complex evolved 2n + 1 times between two shuffles. Batches: the first sample and, where complexes evolve side
/// by side, one step of each complex.
struct ShuffledComplex {
  std::size_t complexes = 2;
  double tolerance =
      1e-6;  ///< converged when the population is smaller than this share of the box (geometric mean) ...
  double improvement = 1e-4;  ///< ... or the best value improved by less than this share ...
  std::uint32_t loops = 10;   ///< ... in so many shuffles
  std::uint64_t seed = 1;
};
Minimum minimise(Function& function, const Box& box, std::span<const double> start, const ShuffledComplex& method,
                 const Limits& limits);

/// Simplex with simulated annealing, SIMPSA [Cardoso1996]: Nelder and Mead whose comparisons are disturbed by a
/// temperature [Press1991] that falls by the schedule of [Aarts1985]; points beyond the box are drawn anew within it.
/// Ends with the undisturbed simplex from the best point seen. Batches: the first simplex, what sets the first
/// temperature, a shrinking, and the last simplex.
struct SimplexAnnealing {
  double first_acceptance = 0.95;         ///< share of worse moves accepted at the first temperature
  double cooling = 1.0;                   ///< rate delta of the schedule
  std::uint32_t moves_per_dimension = 2;  ///< at one temperature, for each dimension; our choice
  double tolerance = 1e-6;                ///< converged when the simplex is smaller than this share of the box
  std::uint64_t seed = 1;
};
Minimum minimise(Function& function, const Box& box, std::span<const double> start, const SimplexAnnealing& method,
                 const Limits& limits);

std::string_view to_string(Stop stop);

}  // namespace gdtslam::optimize
