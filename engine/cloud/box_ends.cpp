#include "box_face.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/core/elementary.hpp"
#include "engine/core/to_position.hpp"

namespace gdtslam {
namespace {

constexpr int kBins = 800;               // bins of the window around the end
constexpr int kReach = 200;              // bins to each side of the first guess that are searched for the end
constexpr double kLeastWindow_m = 0.04;  // least half width of that window
constexpr double kSamplings = 3.0;       // least number of beams in half of the window
constexpr double kOutlier = 1.0e-3;      // share of beams that fall on the wrong side
constexpr std::array kErrors{1.0, 2.0, 4.0, 8.0, 16.0, 32.0};  // errors of the beams' directions, bins
constexpr double kLeastPast = 5;                               // least number of beams that determine an end
constexpr double kBand_m = 0.1;  // band that gives the density of hits if no beam goes past the end
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
constexpr double kGrazing = 1.0e-3;  // least sine of the angle between plane and crossing beam

// Computes the crossing of the plane and the beam from the viewpoint to the point; for a point behind it, its shadow.
void cross(FaceHit& hit, const FaceFrame& face, const Point3& from_origin, const Point3& viewpoint) {
  const Point3 eye = viewpoint - face.origin;
  const Point3 beam = from_origin - eye;
  const double slope = face.normal.dot(beam);
  if (!(slope < -kGrazing * beam.norm())) return;
  const Point3 at = eye - beam * (face.normal.dot(eye) / slope);
  hit.across_m = face.across.dot(at);
  hit.up_m = face.up.dot(at);
}

/// Histogram of the beams by their crossing of the plane, outwards from the inner edge of the window.
struct EndCounts {
  double from_m = 0.0;  ///< outward coordinate of the first bin's inner edge
  double bin_m = 0.0;
  std::array<double, kBins> hit{};
  std::array<double, kBins> passed{};
  double before = 0.0;  ///< outside the first guess: beams that end in front of the plane
  double past = 0.0;    ///< outside the first guess: beams that end behind the plane
  double beyond = 0.0;  ///< outside the first guess: beams that end on the plane
};

EndCounts count(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m) {
  EndCounts counts;
  const double half_m = std::max(kLeastWindow_m, kSamplings * place.sampling_m);
  counts.bin_m = 2.0 * half_m / kBins;
  counts.from_m = place.sign * place.rough_m - half_m;
  for (const FaceHit& hit : hits) {
    const double bin = (place.sign * hit.along(place.axis) - counts.from_m) / counts.bin_m;
    if (!(bin >= 0.0 && bin < kBins) || !place.beside.has(hit.beside(place.axis))) continue;
    const auto k = static_cast<std::size_t>(bin);
    const bool is_outside = bin > 0.5 * kBins + std::max(4.0e-3, 0.5 * place.sampling_m) / counts.bin_m;
    if (std::fabs(hit.depth_m) <= thickness_m) {
      counts.hit[k] += 1.0;
      counts.beyond += is_outside ? 1.0 : 0.0;
    } else if (hit.depth_m > 0.0) {
      counts.passed[k] += 1.0;
      counts.past += is_outside ? 1.0 : 0.0;
    } else {
      counts.before += is_outside ? 1.0 : 0.0;
    }
  }
  return counts;
}

// Bin whose inner edge, taken as the end, leaves the fewest beams on the wrong side.
int first_guess(const EndCounts& counts) {
  double wrong = 0.0;
  for (const double hit : counts.hit) wrong += hit;
  double least = wrong;
  int first = 0;
  int last = 0;
  for (int k = 0; k < kBins; ++k) {
    wrong += counts.passed[static_cast<std::size_t>(k)] - counts.hit[static_cast<std::size_t>(k)];
    if (wrong < least) {
      least = wrong;
      first = k + 1;
    }
    if (wrong <= least) last = k + 1;
  }
  return (first + last) / 2;
}

// Logarithm of the probability that a beam hits, by its distance inside the end in half bins.
std::vector<double> log_probabilities(double error) {
  std::vector<double> table(4 * kBins + 1);
  for (int k = -2 * kBins; k <= 2 * kBins; ++k) {
    const double within = 0.5 * static_cast<double>(k) / error;
    const double share = 1.0 / (1.0 + exp(-within));
    const int row = k + 2 * kBins;
    table[static_cast<std::size_t>(row)] = log(kOutlier + (1.0 - 2.0 * kOutlier) * share);
  }
  return table;
}

// Log likelihood of an end at the inner edge of bin `end`; beams cross at the middle of their bins.
double log_likelihood(const EndCounts& counts, int end, const std::vector<double>& table) {
  double sum = 0.0;
  for (int k = 0; k < kBins; ++k) {
    const int within = 2 * (end - k) - 1;
    const int above = 2 * kBins + within;
    const int below = 2 * kBins - within;
    const auto at = static_cast<std::size_t>(k);
    sum += counts.hit[at] * table[static_cast<std::size_t>(above)] +
           counts.passed[at] * table[static_cast<std::size_t>(below)];
  }
  return sum;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

// Mean and variance of the end over the bins near the guess, with all of kErrors equally likely.
Moments posterior(const EndCounts& counts, int guess) {
  std::vector<std::pair<int, double>> terms;
  double most = -std::numeric_limits<double>::infinity();
  for (const double error : kErrors) {
    const std::vector<double> table = log_probabilities(error);
    for (int end = std::max(0, guess - kReach); end <= std::min(kBins, guess + kReach); ++end) {
      terms.emplace_back(end, log_likelihood(counts, end, table));
      most = std::max(most, terms.back().second);
    }
  }
  double weight = 0.0;
  Moments sum;
  for (const auto& [end, value] : terms) {
    const double share = exp(value - most);
    const double offset = static_cast<double>(end - guess);
    weight += share;
    sum.mean += share * offset;
    sum.variance += share * offset * offset;
  }
  sum.mean /= weight;
  sum.variance = sum.variance / weight - sum.mean * sum.mean;
  sum.mean += guess;
  return sum;
}

// Ends the face at the last hits, assuming that they are as dense up to there as further in.
FaceEnd where_hits_stop(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m) {
  double inner = 0.0;
  double outer = 0.0;
  const double middle_m = place.sign * place.rough_m - 0.5 * kBand_m;
  for (const FaceHit& hit : hits) {
    if (!(std::fabs(hit.depth_m) <= thickness_m) || !place.beside.has(hit.beside(place.axis))) continue;
    const double from_middle = place.sign * hit.along(place.axis) - middle_m;
    inner += from_middle > -0.5 * kBand_m && from_middle <= 0.0 ? 1.0 : 0.0;
    outer += from_middle > 0.0 && from_middle < kBand_m ? 1.0 : 0.0;
  }
  if (inner < kLeastPast) return {place.rough_m, 0.5 * kBand_m, EndKind::kStops};
  const double density = inner / (0.5 * kBand_m);
  const double sigma_m = std::sqrt(outer + outer * outer / inner) / density;
  return {place.sign * (middle_m + outer / density), sigma_m, EndKind::kStops};
}

}  // namespace

std::vector<FaceHit> find_hits(std::span<const CloudPoint> cloud, const FaceFrame& face, const Span& across,
                               const Span& up, const std::optional<Point3>& viewpoint, double thickness_m) {
  std::vector<FaceHit> hits;
  for (const CloudPoint& point : cloud) {
    const Point3 d = to_position(point) - face.origin;
    FaceHit hit{kNowhere, kNowhere, -face.normal.dot(d), face.across.dot(d), face.up.dot(d)};
    if (viewpoint) {
      cross(hit, face, d, *viewpoint);
    } else if (std::fabs(hit.depth_m) <= thickness_m) {
      hit.across_m = hit.point_across_m;
      hit.up_m = hit.point_up_m;
    }
    const bool crosses = across.has(hit.across_m) && up.has(hit.up_m);
    if (crosses || (across.has(hit.point_across_m) && up.has(hit.point_up_m))) hits.push_back(hit);
  }
  return hits;
}

FaceEnd find_end(std::span<const FaceHit> hits, const EndPlace& place, double thickness_m) {
  const EndCounts counts = count(hits, place, thickness_m);
  if (counts.beyond > counts.past + counts.before) return {place.rough_m, 0.0, EndKind::kContinues};
  if (counts.past < kLeastPast && counts.before < kLeastPast) return where_hits_stop(hits, place, thickness_m);
  const Moments bins = posterior(counts, first_guess(counts));
  const double variance = bins.variance + 1.0 / 12.0;  // variance of a position within its bin
  return {place.sign * (counts.from_m + bins.mean * counts.bin_m), std::sqrt(variance) * counts.bin_m,
          counts.past > counts.before ? EndKind::kJump : EndKind::kHidden};
}

}  // namespace gdtslam
