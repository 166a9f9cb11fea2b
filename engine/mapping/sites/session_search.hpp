// Searches keyframes of one session in the whole of another, without a start pose: the certified search lays the
// surroundings of a keyframe where they fit best, and checks whether they fit elsewhere as well. Frame: the map of the
// session that is searched in. Thread-safe. Cost: some tenths of a second a search on an office floor.
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
  double query_half_m = 4.0;          ///< path length to each side of the keyframe in the query
  double reference_half_m = 9.0;      ///< the same for the place of the other session that it is compared with
  double resolution_m = 0.1;          ///< cell size of the distance field
  std::size_t points = 300;           ///< points of a query
  double beyond_m = 5.0;              ///< largest distance of the robot from the path of the other session
  double gap_m = 0.02;                ///< gap of the mean distance to the proven bound
  double as_good_m = 0.03;            ///< a pose elsewhere whose mean distance is larger by no more fits as well
  double as_good_share = 0.5;         ///< or by no more than this share of the best pose's mean distance
  double most_m = 0.08;               ///< largest mean distance of a pose that is examined
  std::uint64_t most_boxes = 500000;  ///< boxes of a search; a pose that needs more counts as not found
  std::size_t most_places = 48;       ///< places of a session, evenly along its path
  std::size_t most_beside = 24;       ///< keyframes beside places that were found
  LoopLimits limits{.least_overlap = 0.5, .most_turned = 0.1, .most_contradiction = 0.05};
};

/// Pose of a keyframe of one session in another session.
struct SessionFix {
  std::size_t keyframe = 0;         ///< keyframe that is searched
  std::size_t reference_place = 0;  ///< nearby place of the other session that saw enough of the same walls
  Pose2 T_map_keyframe;             ///< in the other's map
  LoopEvidence evidence;
  double mean_m = 0.0;                     ///< distance of its points to the other's
  double elsewhere_m = 0.0;                ///< lower bound of the same distance anywhere else
  bool is_possible = false;                ///< no evidence is against it
  bool is_alone = false;                   ///< possible, and it fits nowhere else
  std::optional<Pose2> T_map_elsewhere{};  ///< pose at another place at which it fits as well
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
  /// Best other pose with nothing against it; empty if the keyframe fits nowhere else.
  [[nodiscard]] std::optional<Pose2> find_elsewhere(const Session& query, std::size_t keyframe,
                                                    const Pose2& T_map_keyframe) const;
  /// Evidence for and against the keyframe lying at this pose, from the view around a keyframe of this session.
  [[nodiscard]] LoopEvidence weigh(const Session& query, std::size_t keyframe, std::size_t reference,
                                   const Pose2& T_map_keyframe) const;
  /// True if the fix fits as well at this pose, or slightly beside it.
  [[nodiscard]] bool fits(const Session& query, const SessionFix& fix, const Pose2& T_map_keyframe) const;
  /// True if the fix still fits as well as before anywhere but at this pose.
  [[nodiscard]] bool fits_elsewhere(const Session& query, const SessionFix& fix, const Pose2& T_map_keyframe) const;
  /// True if the query's path, laid at this pose, leads through a wall.
  [[nodiscard]] bool has_walls_in_the_way(const Session& query, const Pose2& T_map_query) const;
  /// Tests whether the keyframe, at this pose or slightly beside it, lies where this session drove, and whether its
  /// surroundings fit there.
  enum class Test : std::uint8_t { kElsewhere, kFits, kDoesNotFit };
  [[nodiscard]] Test test(const Session& query, std::size_t keyframe, const Pose2& T_map_keyframe) const;
  /// Tests the walls against the site's views around: if it saw little, unseen parts count neither for nor against.
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

/// Places of a session, as keyframes, evenly along its path, in the order of the search: first those far from each
/// other.
std::vector<std::size_t> places_to_look_for(const Session& query, std::size_t most);
/// Size of the walls that a session saw: number of half-metre squares that hold a point.
std::size_t count_wall_points(const Session& session);
/// Keyframes to both sides of a keyframe that was found: sessions that overlap little share only a place or two.
std::vector<std::size_t> keyframes_beside(const Session& query, std::size_t keyframe);

/// True if two keyframes of a session are at one place: within a metre of path.
bool are_at_one_place(const Session& session, std::size_t a, std::size_t b);

/// Limits for agreement among possible fixes that fit nowhere else: the largest set of fixes that each agree with the
/// middle one within `near_m` and `near_rad`, plus a share of the path in between for the drift of both.
struct AgreementLimits {
  double near_m = 0.10;
  double near_rad = 0.0174532925199432955;  ///< a degree
  double drift_m_per_m = 0.01;
  double drift_rad_per_m = 0.0005;
  std::size_t least = 3;
};
/// Indices into the fixes, ascending; empty if fewer than `least` agree.
std::vector<std::size_t> agreeing(const Session& query, const std::vector<SessionFix>& fixes,
                                  const AgreementLimits& limits = {});

}  // namespace gdtslam
