// Systems whose own factor would be large: conjugate gradients with the factor of a system that is much like it as
// preconditioner [GolubVanLoan2013, section 11.5], for graphs one of a part of their edges [Dellaert2010]. Sums in a
// fixed order, the same bits on every host. Cost: a product and a solution with the factor a step.
#pragma once

#include <vector>

#include "block_cholesky.hpp"

namespace gdtslam {

/// Solves for system.right to a ten-thousandth, or as far as some hundred steps come, each of which is nearer than the
/// last; nothing where the systems are not of numbers.
std::vector<Tangent2> solve_near(const BlockSystem& system, const BlockCholesky& factor);

}  // namespace gdtslam
