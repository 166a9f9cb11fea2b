#include "edit_steps.hpp"

namespace gdtslam {
namespace {

/// Takes one step after the other.
struct PlanMaker {
  EditPlan plan;

  void operator()(const FrameEdit& edit) {
    if (edit.T_before_after == Pose2{}) return;
    const Pose2 T_after_before = inverse(edit.T_before_after);
    plan.T_edited_run = plan.has_other_frame ? T_after_before * plan.T_edited_run : T_after_before;
    plan.has_other_frame = true;
    for (std::vector<MapRegion>* regions : {&plan.erased, &plan.kept}) {
      for (MapRegion& region : *regions) region = in_frame(T_after_before, region);
    }
    if (plan.T_world_edited) plan.T_world_edited = *plan.T_world_edited * edit.T_before_after;
  }
  void operator()(const EraseEdit& edit) { plan.erased.push_back(edit.region); }
  void operator()(const CropEdit& edit) { plan.kept.push_back(rectangle_between(edit.low_m, edit.high_m)); }
  void operator()(const GeoreferenceEdit& edit) { plan.T_world_edited = edit.fit.T_world_map; }
  void operator()(const WorldFileEdit& /*edit*/) { plan.with_world_file = true; }
};

}  // namespace

EditPlan plan_of(const std::vector<EditStep>& steps, const EditPlan& earlier) {
  PlanMaker maker;
  maker.plan.T_world_edited = earlier.T_world_edited;
  maker.plan.with_world_file = earlier.with_world_file;
  for (const EditStep& step : steps) std::visit(maker, step);
  return maker.plan;
}

}  // namespace gdtslam
