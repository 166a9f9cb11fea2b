#include "share.hpp"

#include <algorithm>
#include <cmath>

namespace gdtslam {
namespace {

constexpr double kZ = 1.959963984540054;  // of 95 %, both sides

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

Interval wilson(std::uint64_t count, std::uint64_t of) {
  if (of == 0) return {};
  const auto k = static_cast<double>(count);
  const auto n = static_cast<double>(of);
  const double middle = (k + 0.5 * kZ * kZ) / (n + kZ * kZ);
  const double half = kZ * std::sqrt(k * (n - k) / n + 0.25 * kZ * kZ) / (n + kZ * kZ);
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace

double Share::value() const { return of > 0 ? static_cast<double>(count) / static_cast<double>(of) : 0.0; }
double Share::low() const { return wilson(count, of).low; }
double Share::high() const { return wilson(count, of).high; }

}  // namespace gdtslam
