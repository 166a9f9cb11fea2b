// The variants of the method that `gdtslam-lab ablation` compares: each a list of assignments on top of the
// configuration.
#pragma once

#include <string>
#include <vector>

namespace gdtslam {

struct AblationVariant {
  std::string name;
  std::vector<std::string> sets;  ///< path=value
};

inline std::vector<AblationVariant> default_variants() {
  return {
      {"as configured", {}},
      {"merge (10), (11) as printed", {"merge.rule=literal"}},
      {"κ = 1", {"merge.kappa=1"}},
      {"every scan merged", {"keyframe.every_scan=true"}},
      {"matcher simplex", {"match.matcher=simplex"}},
      {"matcher exhaustive", {"match.matcher=exhaustive"}},
      {"simplex, squared distance, (1) as printed", {"match.matcher=simplex", "match.cost=squared"}},
      {"simplex, nearest cell instead of bilinear", {"match.matcher=simplex", "match.interpolation=nearest"}},
      {"no window search", {"search.when=never"}},
      {"no prior from odometry", {"prior.weight=0"}},
  };
}

}  // namespace gdtslam
