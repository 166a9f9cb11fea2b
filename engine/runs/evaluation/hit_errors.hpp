// Distance of each point of a cloud from the true hit of its beam. Points and hits are matched by scan and by the time
// of the beam, so a thinned cloud can be judged too. Both files are in the order of scans and beams, and are read piece
// by piece.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "distance_histogram.hpp"
#include "errors.hpp"
#include "gdtslam/calib/sweep_model.hpp"

namespace gdtslam {

/// Rounding steps of encoder and ranges, for calib::quantisation_bound_m.
struct Quantisation {
  calib::SweepModel model;
  double range_resolution_m = 0.0;
};

struct HitErrorsJob {
  std::string cloud;
  std::string hits;  ///< file of simulate --truth-hits
  CloudFrame frame;
  std::optional<Quantisation> quantisation{};
  std::function<void(std::uint64_t, double)> progress{};
  std::function<bool()> stop{};
};

/// Points compared with the bound, each at its true range rounded up to 10 cm.
struct BoundCheck {
  std::uint64_t beyond = 0;    ///< points with a distance above their bound
  double largest_share = 0.0;  ///< largest ratio of a distance to its bound
  double largest_bound_m = 0.0;
};

struct HitErrors {
  DistanceHistogram distances;
  std::uint64_t hits = 0;         ///< in the file
  std::uint64_t without_hit = 0;  ///< points without a hit of their beam
  std::optional<BoundCheck> bound{};
  bool interrupted = false;
};

/// Throws InputError or FileError for the files; InputError if no point has a hit, or the cloud lacks scan and time;
/// ConfigError for the model.
HitErrors hit_errors(const HitErrorsJob& job);

}  // namespace gdtslam
