// The parts of a linkage's drawing. Thread-safe.
#pragma once

#include "gdtslam/drawing/canvas.hpp"
#include "linkage_table.hpp"

namespace gdtslam {

struct Box {
  Point2 corner = Point2::Zero();  ///< upper left
  double width = 0.0;
  double height = 0.0;
};

/// Crank angle from the lift's begin to its end, in the direction of the crank; of the stretch where nothing lifts.
double lift_span_rad(const LinkageSummary& summary);
/// The position that is drawn in full: within the lift, where coupler and rocker are nearest to a right angle.
double shown_crank_rad(const LinkageSummary& summary);

void draw_positions(Canvas& canvas, const LinkageSummary& summary, double shown_rad, const Box& box);
void draw_elevation(Canvas& canvas, const LinkageSummary& summary, double shown_rad, const Box& box);
void draw_transmission(Canvas& canvas, const LinkageSummary& summary, double shown_rad, const Box& box);

}  // namespace gdtslam
