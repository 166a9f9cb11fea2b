// Systems that changed by little since they were factorised: conjugate gradients with the old factor as preconditioner
// [GolubVanLoan2013, section 11.5]. Sums in a fixed order, the same bits on every host. Cost: a product and a solution
// with the factor a step, a hundredth of a factorisation for a map of a building.
#pragma once

#include <vector>

#include "block_cholesky.hpp"

namespace gdtslam {

/// Solves for system.right by the factor of a system that is much like it; nothing where its solution is not found to a
/// ten-thousandth in so many steps, because the systems have too little in common.
std::vector<Tangent2> solve_near(const BlockSystem& system, const BlockCholesky& factor, int most_steps = 12);

}  // namespace gdtslam
