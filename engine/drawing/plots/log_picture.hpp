// A log at a glance: scan rate, motion by odometry, ranges and missing returns, one below the other over one time axis.
// Thread-safe; O(values).
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

/// What the picture shows. Time is seconds from the start of the log, or the scans' numbers; what is not finite is a
/// gap in a curve.
struct LogPicture {
  /// How returns of one stretch of time spread: the quantiles 0.05, 0.25, 0.5, 0.75 and 0.95, metres.
  struct Ranges {
    double time_s = 0.0;
    double least_m = 0.0;
    double lower_m = 0.0;
    double median_m = 0.0;
    double upper_m = 0.0;
    double most_m = 0.0;
  };
  std::string title;
  std::string subtitle;
  bool is_by_time = true;
  double length = 1.0;
  std::vector<Point2> rates_hz;     ///< scans a second, from each time on; empty: no place for it
  std::vector<Point2> speeds_m_s;   ///< empty: there is no odometry, and no place for it
  std::vector<Point2> turns_deg_s;  ///< likewise; counter-clockwise above 0
  std::vector<std::pair<Point2, Point2>>
      elevations_deg;  ///< of a tilting laser, least and most; empty: no place for it
  std::vector<Ranges> ranges;
  std::vector<Point2> missing_percent;            ///< beams without return
  std::vector<std::pair<double, double>> gaps_s;  ///< no scans from then to then
  std::vector<double> jumps_s;                    ///< steps of the odometry that no robot makes
};

/// How high a picture of that width should be for its curves.
PictureSize size_of_log_picture(const LogPicture& log);

/// Throws nothing; values beyond the frame are cut off.
Canvas log_picture(const LogPicture& log, const PictureSize& size);

}  // namespace gdtslam
