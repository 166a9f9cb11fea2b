// The choice between polished poses, and the evidence for it.

/// Values of the map under all points at a pose; see engine/compute/kernels/pose_simplex/pose_simplex.hpp.
struct PoseEvidence {
  std::uint32_t sum;
  std::uint32_t near;
  std::uint32_t beside;
  std::uint32_t known;
};

inline CostPose cost_pose(const PolishedPose& pose) {
  const SinCos<float> rotation = sin_cos(pose.theta);
  return {rotation.sin, rotation.cos, pose.x, pose.y};
}

/// The field at the nearest cell of each point, before any cap; `nearest` is a context without interpolation.
void nearest_values(const CostContext& nearest, const CostPose& pose, std::uint16_t* values) {
  for (std::uint32_t i = 0; i < nearest.count; ++i) {
    const PointCells point = nearest.points[i];
    const float u = (pose.c * point.x - pose.s * point.y) + pose.x;
    const float v = (pose.s * point.x + pose.c * point.y) + pose.y;
    const std::int32_t qx = floor_position(u * 256.0F + 0.5F) + nearest.shift_x;
    const std::int32_t qy = floor_position(v * 256.0F + 0.5F) + nearest.shift_y;
    const auto x = static_cast<std::uint32_t>(clamped(qx >> 8, 0, nearest.last_x));
    const auto y = static_cast<std::uint32_t>(clamped(qy >> 8, 0, nearest.last_y));
    const std::uint32_t place = field_place(x, y, nearest.stride, nearest.strip_step);
    values[i] = u16(u32(nearest.field[place]) ^ (nearest.blank & 0xFFFFU));
  }
}

PoseEvidence gather_evidence(const ChoosePose::Params& params, const std::uint16_t* values) {
  const std::uint32_t gate = params.gate;
  const std::uint32_t wide = params.cost.cap;
  const std::uint32_t map_cap = params.map_cap;
  PoseEvidence evidence{0, 0, 0, 0};
  for (std::uint32_t i = 0; i < params.cost.point_count; ++i) {
    const std::uint32_t value = values[i];
    evidence.sum += lesser(value, wide);
    evidence.near += value <= gate ? 1U : 0U;
    evidence.beside += value > 2 * gate && value < map_cap ? 1U : 0U;
    evidence.known += value < map_cap ? 1U : 0U;
  }
  return evidence;
}

inline bool is_suspect(const ChoosePose::Params& params, const PoseEvidence& local) {
  return local.beside * 65536U > params.contradiction_q16 * local.known ||
         local.near * 65536U < params.overlap_q16 * params.cost.point_count;
}

inline bool is_far(const ChoosePose::Params& params, const PolishedPose& pose) {
  const float dx = pose.x - params.prior.mean_x;
  const float dy = pose.y - params.prior.mean_y;
  const float dt = pose.theta - params.prior.mean_theta;
  return dx * dx + dy * dy > params.far_sq_cells || __builtin_fabsf(dt) > params.far_rad;
}

/// Packs the points over known cells at pose 0; returns their number.
std::uint32_t keep_voters(const ChoosePose::Params& params, const PointCells* points, const std::uint16_t* values,
                          PointCells* voters) {
  const std::uint32_t limit = lesser(params.cost.cap, params.map_cap);
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < params.cost.point_count; ++i) {
    voters[kept] = points[i];
    kept += values[i] < limit ? 1U : 0U;
  }
  return kept;
}

/// `values` and `voters` are scratch, one entry a point each.
void choose_pose(const ChoosePose::Params& params, const std::uint16_t* field, const PointCells* points,
                 const PolishedPose* poses, MatchVerdict* verdict, std::uint16_t* values, PointCells* voters) {
  PoseCost::Params nearest_params = params.cost;
  nearest_params.interpolation = Interpolation::kNearest;
  const CostContext nearest = cost_context(nearest_params, field, points);
  nearest_values(nearest, cost_pose(poses[0]), values);
  PoseEvidence evidence = gather_evidence(params, values);

  PoseObjective objective{cost_context(params.cost, field, points), choose_point_sum(params.cost), params.prior};
  if (!is_suspect(params, evidence)) {
    objective.context.points = voters;
    objective.context.count = keep_voters(params, points, values, voters);
  }
  const bool leaps_cost = params.leap_q8 != 0 && !is_far(params, poses[0]);
  MatchVerdict best{};
  std::uint32_t evaluations = 0;
  for (std::uint32_t i = 0; i < params.pose_count; ++i) {
    const PolishedPose& pose = poses[i];
    std::uint32_t cost = cost_at(objective, pose.x, pose.y, pose.theta);
    if (i == 0) {
      best.local_cost = cost;
    } else if (leaps_cost && is_far(params, pose)) {
      const std::uint64_t raised = (std::uint64_t{cost} * params.leap_q8) >> 8U;
      cost = raised < 0xFFFFFFFFU ? static_cast<std::uint32_t>(raised) : 0xFFFFFFFFU;
    }
    evaluations += pose.evaluations;
    if (i == 0 || cost < best.cost) {
      best.cost = cost;
      best.chosen = i;
    }
  }

  const PolishedPose& chosen = poses[best.chosen];
  if (best.chosen != 0) {
    nearest_values(nearest, cost_pose(chosen), values);
    evidence = gather_evidence(params, values);
  }
  *verdict = {chosen.x,       chosen.y,     chosen.theta,  best.cost,       best.chosen,    evaluations,
              chosen.stop,    evidence.sum, evidence.near, evidence.beside, evidence.known, objective.context.count,
              best.local_cost};
}
