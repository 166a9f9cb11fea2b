// Where the simplexes of `exhaustive` start.

void pose_starts(const PoseStarts::Params& params, const PoseCandidate* candidates, const std::uint32_t* picks,
                 PolishedPose* poses, std::uint32_t begin, std::uint32_t end) {
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::uint32_t index = i == 0 ? params.candidate_count : picks[2 * i - 1];
    if (index < params.candidate_count) {
      const PoseCandidate& picked = candidates[index];
      poses[i] = {picked.x, picked.y, picked.theta};
    } else {
      poses[i] = {params.x, params.y, params.theta};
    }
  }
}
