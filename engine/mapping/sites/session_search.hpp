// Keyframes of one session searched in the whole of another, without any idea where: what the robot saw around one,
// laid by the certified search where it fits best, and whether it fits elsewhere as well. Frame: the map of the session
// that is searched in. Thread-safe. Cost: some tenths of a second a search on an office floor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/core/worker_pool.hpp"
#include "engine/mapping/loops/loop_verdict.hpp"
#include "engine/mapping/sites/session.hpp"

namespace gdtslam {

struct SessionSearchOptions {
  double query_half_m = 4.0;          ///< path length to each side of a keyframe that is looked for
  double reference_half_m = 9.0;      ///< and of the place of the other session that it is held against
  double resolution_m = 0.1;          ///< cell size of the distance field
  std::size_t points = 300;           ///< points of a query
  double beyond_m = 5.0;              ///< the robot was at most so far from where the other one drove
  double gap_m = 0.02;                ///< gap of the mean distance to the proven bound
  double as_good_m = 0.03;            ///< a pose elsewhere whose mean distance is larger by no more fits as well
  double as_good_share = 0.5;         ///< or by no more than this share of the best one's
  double most_m = 0.08;               ///< mean distance beyond which a pose is not worth to be looked at
  std::uint64_t most_boxes = 500000;  ///< boxes of a search; a pose that needs more was not found
  std::size_t most_places = 48;       ///< places of a session, evenly along its path
  std::size_t most_beside = 24;       ///< keyframes beside places that were found
  LoopLimits limits{.least_overlap = 0.5, .most_turned = 0.1, .most_contradiction = 0.05};
};

/// Pose of a keyframe of one session in another session.
struct SessionFix {
  std::size_t keyframe = 0;         ///< keyframe that is looked for
  std::size_t reference_place = 0;  ///< nearby place of the other session that saw enough of it
  Pose2 T_map_keyframe;             ///< in the other's map
  LoopEvidence evidence;
  double mean_m = 0.0;                     ///< distance of its points to the other's
  double elsewhere_m = 0.0;                ///< at least, anywhere else
  bool is_possible = false;                ///< no evidence is against it
  bool is_alone = false;                   ///< and it fits nowhere else as well
  std::optional<Pose2> T_map_elsewhere{};  ///< pose elsewhere, in one of the places, at which it fits as well
};

/// A session that others are searched in.
class SessionMap {
 public:
  /// `session` must outlive this.
  SessionMap(const Session& session, const SessionSearchOptions& options);
  ~SessionMap();
  SessionMap(const SessionMap&) = delete;
  SessionMap& operator=(const SessionMap&) = delete;

  [[nodiscard]] SessionFix find(const Session& query, std::size_t keyframe) const;
  /// Best pose other than this one with nothing against it; empty if it fits nowhere else.
  [[nodiscard]] std::optional<Pose2> find_elsewhere(const Session& query, std::size_t keyframe,
                                                    const Pose2& T_map_keyframe) const;
  /// Evidence for and against the keyframe lying there, by the view around a keyframe of this session.
  [[nodiscard]] LoopEvidence weigh(const Session& query, std::size_t keyframe, std::size_t reference,
                                   const Pose2& T_map_keyframe) const;
  /// Whether what was found fits as well there, or a little beside.
  [[nodiscard]] bool fits(const Session& query, const SessionFix& fix, const Pose2& T_map_keyframe) const;
  /// Whether it fits as well, as it did when it was found, anywhere but there.
  [[nodiscard]] bool fits_elsewhere(const Session& query, const SessionFix& fix, const Pose2& T_map_keyframe) const;
  /// Whether the query's path, laid so, leads through a wall.
  [[nodiscard]] bool has_walls_in_the_way(const Session& query, const Pose2& T_map_query) const;
  /// Whether the keyframe, taken there or a little beside, would lie where this session drove, and whether what was
  /// seen around it fits then at all.
  enum class Test : std::uint8_t { kElsewhere, kFits, kDoesNotFit };
  [[nodiscard]] Test test(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const;
  /// Tests the walls against the site's views around: where it saw little, unseen parts speak neither for nor against.
  [[nodiscard]] Test test_walls(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const;

 private:
  struct State;
  [[nodiscard]] double mean_beside_m(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const;
  [[nodiscard]] double as_good_m(const SessionFix& fix) const;
  void hold_against_places(const Session& query, SessionFix& fix) const;
  [[nodiscard]] std::vector<std::size_t> places_near(const Pose2& T_map_keyframe) const;
  [[nodiscard]] std::size_t place_near(const Pose2& T_map_keyframe) const;
  [[nodiscard]] bool is_near(const Pose2& T_map_keyframe) const;

  const Session& session_;
  SessionSearchOptions options_;
  std::unique_ptr<State> state_;
};

/// Places of a session, as keyframes, evenly along its path, in the order in which they are worth to be looked for:
/// first those that are far from each other.
std::vector<std::size_t> places_to_look_for(const Session& query, std::size_t most);
/// How much of walls a session saw, in squares of half a metre that hold a point.
std::size_t count_wall_points(const Session& session);
/// Keyframes beside one that was found, to both sides: sessions that overlap little have but a place or two in common.
std::vector<std::size_t> keyframes_beside(const Session& query, std::size_t keyframe);

/// Whether two keyframes of a session are at one place: within a metre of path.
bool are_at_one_place(const Session& session, std::size_t a, std::size_t b);

/// Limits for agreement among possible fixes that fit nowhere else: the largest set that agrees, each with the one in
/// their middle within `near_m` and `near_rad`, and a share of the path in between for the drift of both.
struct AgreementLimits {
  double near_m = 0.10;
  double near_rad = 0.0174532925199432955;  ///< a degree
  double drift_m_per_m = 0.01;
  double drift_rad_per_m = 0.0005;
  std::size_t least = 3;
};
/// Indices into the fixes, ascending; empty where fewer than `least` agree.
std::vector<std::size_t> agreeing(const Session& query, const std::vector<SessionFix>& fixes,
                                  const AgreementLimits& limits = {});

}  // namespace gdtslam
