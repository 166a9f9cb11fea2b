// The instruction sets that tests can run here.
#pragma once

#include <vector>

#include "gdtslam/compute/backend.hpp"

namespace gdtslam::test {

inline std::vector<Isa> available_isas() {
  std::vector<Isa> list;
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    if (isa_available(isa)) {
      list.push_back(isa);
    }
  }
  return list;
}

}  // namespace gdtslam::test
