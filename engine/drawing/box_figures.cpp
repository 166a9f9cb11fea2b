#include <algorithm>
#include <cassert>

#include "engine/core/quantile.hpp"
#include "gdtslam/drawing/plot.hpp"

namespace gdtslam {
BoxFigures box_figures(std::vector<double> values) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  BoxFigures figures;
  figures.lower_quartile = quantile_of_sorted(values, 0.25);
  figures.median = quantile_of_sorted(values, 0.5);
  figures.upper_quartile = quantile_of_sorted(values, 0.75);
  const double reach = 1.5 * (figures.upper_quartile - figures.lower_quartile);
  figures.low_whisker = figures.lower_quartile;
  figures.high_whisker = figures.upper_quartile;
  for (const double value : values) {
    if (value < figures.lower_quartile - reach || value > figures.upper_quartile + reach) {
      figures.beyond.push_back(value);
    } else {
      figures.low_whisker = std::min(figures.low_whisker, value);
      figures.high_whisker = std::max(figures.high_whisker, value);
    }
  }
  return figures;
}

}  // namespace gdtslam
