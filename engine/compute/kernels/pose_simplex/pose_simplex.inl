// The downhill simplex on the cost of a pose. The order of the operations is that of the header, bit for bit.

/// Sum of the points' terms, for one interpolation and form.
using PointSum = std::uint32_t (*)(const CostContext&, const CostPose&);

inline PointSum choose_point_sum(const PoseCost::Params& params) {
  const bool squared = params.form == CostForm::kSquared;
  if (params.interpolation == Interpolation::kBilinear) {
    return squared ? point_sum<true, true> : point_sum<true, false>;
  }
  return squared ? point_sum<false, true> : point_sum<false, false>;
}

/// Cost of a prior at a pose, cut towards zero; the sum is at most 2e9, which int32 holds.
inline std::uint32_t prior_cost(const PriorParams& prior, float x, float y, float theta) {
  const float dx = x - prior.mean_x;
  const float dy = y - prior.mean_y;
  const float dt = theta - prior.mean_theta;
  const float shift_cost = limited((dx * dx + dy * dy) * prior.weight_xy, prior.limit);
  const float turn_cost = limited((dt * dt) * prior.weight_theta, prior.limit);
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(shift_cost + turn_cost));
}

/// The minimised function: the points' sum plus the prior.
struct PoseObjective {
  CostContext context;
  PointSum sum;
  PriorParams prior;
};

inline std::uint32_t cost_at(const PoseObjective& objective, float x, float y, float theta) {
  const SinCos<float> rotation = sin_cos(theta);
  const std::uint32_t sum = objective.sum(objective.context, {rotation.sin, rotation.cos, x, y});
  const std::uint32_t total = sum + prior_cost(objective.prior, x, y, theta);
  return total < sum ? 0xFFFFFFFFU : total;
}

struct SimplexVertex {
  float x;
  float y;
  float theta;
  std::uint32_t cost;
};

/// Four vertices, sorted by cost between two moves.
struct Simplex {
  SimplexVertex v[4];
};

/// from + factor * (to - from); without its cost.
inline SimplexVertex along(const SimplexVertex& from, const SimplexVertex& to, float factor) {
  return {from.x + factor * (to.x - from.x), from.y + factor * (to.y - from.y),
          from.theta + factor * (to.theta - from.theta), 0};
}

inline SimplexVertex centre_of_best(const Simplex& s) {
  constexpr float kThird = 1.0F / 3.0F;
  return {(s.v[0].x + s.v[1].x + s.v[2].x) * kThird, (s.v[0].y + s.v[1].y + s.v[2].y) * kThird,
          (s.v[0].theta + s.v[1].theta + s.v[2].theta) * kThird, 0};
}

/// Stable: equal costs keep their order.
inline void sort_by_cost(Simplex& s) {
  for (std::uint32_t i = 1; i < 4; ++i) {
    const SimplexVertex moved = s.v[i];
    std::uint32_t place = i;
    for (; place > 0 && moved.cost < s.v[place - 1].cost; --place) {
      s.v[place] = s.v[place - 1];
    }
    s.v[place] = moved;
  }
}

/// The larger one; NaN does not count.
inline float larger_size(float size, float difference) {
  const float length = __builtin_fabsf(difference);
  return size < length ? length : size;
}

inline bool is_small(const Simplex& s, const PoseSimplex::Params& params) {
  float xy = 0.0F;
  float theta = 0.0F;
  for (std::uint32_t i = 1; i < 4; ++i) {
    xy = larger_size(larger_size(xy, s.v[i].x - s.v[0].x), s.v[i].y - s.v[0].y);
    theta = larger_size(theta, s.v[i].theta - s.v[0].theta);
  }
  return xy < params.stop_cells && theta < params.stop_rad;
}

/// One descent; it counts its evaluations.
class SimplexWalk {
 public:
  SimplexWalk(const PoseObjective& objective, const PoseSimplex::Params& params)
      : objective_(objective), params_(params) {}

  void run(PolishedPose& pose) {
    begin(pose.x, pose.y, pose.theta);
    pose.stop = 1;
    while (!is_small(s_, params_)) {
      if (evaluations_ >= params_.max_evaluations) {
        pose.stop = 2;
        break;
      }
      if (!move_worst()) {
        shrink();
      }
      sort_by_cost(s_);
    }
    pose.x = s_.v[0].x;
    pose.y = s_.v[0].y;
    pose.theta = s_.v[0].theta;
    pose.cost = s_.v[0].cost;
    pose.evaluations += evaluations_;
  }

 private:
  void begin(float x, float y, float theta) {
    s_ = {{{x, y, theta, 0},
           {x + params_.step_cells, y, theta, 0},
           {x, y + params_.step_cells, theta, 0},
           {x, y, theta + params_.step_rad, 0}}};
    for (SimplexVertex& vertex : s_.v) {
      evaluate(vertex);
    }
    sort_by_cost(s_);
  }

  void evaluate(SimplexVertex& vertex) {
    ++evaluations_;
    vertex.cost = cost_at(objective_, vertex.x, vertex.y, vertex.theta);
  }

  SimplexVertex evaluated_along(const SimplexVertex& from, const SimplexVertex& to, float factor) {
    SimplexVertex vertex = along(from, to, factor);
    evaluate(vertex);
    return vertex;
  }

  /// Returns false if the simplex must shrink.
  bool move_worst() {
    SimplexVertex& worst = s_.v[3];
    const SimplexVertex centre = centre_of_best(s_);
    const SimplexVertex reflected = evaluated_along(centre, worst, -1.0F);
    if (reflected.cost < s_.v[0].cost) {
      const SimplexVertex expanded = evaluated_along(centre, worst, -2.0F);
      worst = expanded.cost < reflected.cost ? expanded : reflected;
      return true;
    }
    if (reflected.cost < s_.v[2].cost) {
      worst = reflected;
      return true;
    }
    const bool outside = reflected.cost < worst.cost;
    const SimplexVertex contracted = evaluated_along(centre, worst, outside ? -0.5F : 0.5F);
    if (contracted.cost >= lesser(reflected.cost, worst.cost)) {
      return false;
    }
    worst = contracted;
    return true;
  }

  void shrink() {
    for (std::uint32_t i = 1; i < 4; ++i) {
      s_.v[i] = evaluated_along(s_.v[0], s_.v[i], 0.5F);
    }
  }

  const PoseObjective& objective_;
  const PoseSimplex::Params& params_;
  Simplex s_{};
  std::uint32_t evaluations_ = 0;
};

void pose_simplex(const PoseSimplex::Params& params, const std::uint16_t* field, const PointCells* points,
                  PolishedPose* poses, Slice slice) {
  const PoseObjective objective{cost_context(params.cost, field, points), choose_point_sum(params.cost), params.prior};
  for (std::uint32_t i = slice.begin; i < slice.end; ++i) {
    SimplexWalk(objective, params).run(poses[i]);
  }
}
