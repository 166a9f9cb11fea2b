// A simplex and the points that the rules of Nelder and Mead try next; shared by the plain and the annealed method.
#pragma once

#include <span>
#include <vector>

#include "counted.hpp"

namespace gdtslam::optimize {

/// Centre of all vertices but the last.
Point centre_of(std::span<const Valued> vertices);
/// centre + factor * (worst - centre): -1 reflects, -2 expands, 1/2 and -1/2 contract.
Point along(const Point& centre, const Point& worst, double factor);
/// A start and one vertex along each dimension, turned inwards where the step would leave the box; not valued.
std::vector<Valued> first_simplex(const Counted& function, const Point& start, std::span<const double> steps);
/// All vertices but the first half way to it, valued.
void shrink(Counted& function, std::span<Valued> vertices);

}  // namespace gdtslam::optimize
