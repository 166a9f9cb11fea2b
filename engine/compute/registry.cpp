// The list of all kernels. A kernel that is missing here does not exist for the tests, the benchmark and verify; the
// completeness test compares the list with the headers in kernels/.
#include <algorithm>

#include "engine/compute/kernels/distance_field/distance_field.hpp"
#include "engine/compute/kernels/edt/edt.hpp"
#include "engine/compute/kernels/gdt_merge/gdt_merge.hpp"
#include "engine/compute/kernels/jump_flood/jump_flood.hpp"
#include "engine/compute/kernels/pose_bounds/pose_bounds.hpp"
#include "engine/compute/kernels/pose_cost/pose_cost.hpp"
#include "engine/compute/kernels/pose_lattice/pose_lattice.hpp"
#include "engine/compute/kernels/pose_simplex/pose_simplex.hpp"
#include "engine/compute/kernels/sweep_points/sweep_points.hpp"
#include "gdtslam/compute/kernel.hpp"

namespace gdtslam {

std::string_view to_string(Isa isa) {
  switch (isa) {
    case Isa::kBaseline:
      return "baseline";
    case Isa::kAvx2:
      return "avx2";
    case Isa::kAvx512:
      return "avx512";
  }
  return "unknown";
}

std::span<const KernelInfo* const> kernel_registry() {
  static const std::array kernels{&EdtColumns::info(),    &EdtRows::info(),           &JumpFloodInit::info(),
                                  &JumpFloodStep::info(), &JumpFloodDistance::info(), &DistanceField::info(),
                                  &PoseCost::info(),      &GdtMerge::info(),          &PoseLattice::info(),
                                  &LatticeMinima::info(), &SmallestValues::info(),    &SeedScatter::info(),
                                  &FieldGrow::info(),     &PoseStarts::info(),        &PoseSimplex::info(),
                                  &ChoosePose::info(),    &SweepPoints::info(),       &PoseBounds::info()};
  return kernels;
}

const KernelInfo* find_kernel(std::string_view name) {
  const auto all = kernel_registry();
  const auto found = std::find_if(all.begin(), all.end(), [name](const KernelInfo* k) { return k->name == name; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace gdtslam
