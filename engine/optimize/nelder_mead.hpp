// The descent of a simplex that is valued already; the end of the annealed method too.
#pragma once

#include <vector>

#include "counted.hpp"

namespace gdtslam::optimize {

/// Until the simplex is smaller than the tolerances or a limit is met; the vertices are sorted then.
void descend(Counted& function, std::vector<Valued>& vertices, const NelderMead& method);

}  // namespace gdtslam::optimize
