#include "gdtslam/mapping/match.hpp"

namespace gdtslam {

std::string_view to_string(Doubt doubt) {
  switch (doubt) {
    case Doubt::kNone:
      return "none";
    case Doubt::kFewPoints:
      return "few-points";
    case Doubt::kLowOverlap:
      return "low-overlap";
    case Doubt::kContradiction:
      return "contradiction";
    case Doubt::kWeakEvidence:
      return "weak-evidence";
    case Doubt::kFarFromPrediction:
      return "far-from-prediction";
  }
  return "unknown";
}

std::string_view to_string(StopReason reason) {
  switch (reason) {
    case StopReason::kNotRun:
      return "not-run";
    case StopReason::kConverged:
      return "converged";
    case StopReason::kEvaluationLimit:
      return "evaluation-limit";
  }
  return "unknown";
}

}  // namespace gdtslam
