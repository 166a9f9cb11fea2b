// The run of lasers that do not nod: scans are mapped observation by observation, and the loops are closed once the log
// has ended.
#include <algorithm>
#include <utility>

#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/core/error.hpp"
#include "map_run.hpp"

namespace gdtslam {

void MapRun::read_next(ScanAhead& ahead, NextObservation& next) {
  try {
    if (!stop_()) next.observation = next_unless_stopped(ahead, stop_);
  } catch (...) {
    next.problem = std::current_exception();
  }
  watch_.add_cpu_to(outcome_.read_cpu_s);
}

// A fault of the next observation is reported after this one.
MatchResult MapRun::match(const Observation& observation, std::vector<ObservedScan>& places, ScanAhead& ahead,
                          NextObservation& next) {
  const ScanRecord& last = observation.back();
  const MatchResult result = observation.size() == 1
                                 ? mapper_->process(last.scan, last.T_odom_base)
                                 : mapper_->process(observation_points_.points(observation, places), last.T_odom_base);
  observation_points_.take(observation, result, places);
  if (request_.scan_mapped) report_scans(observation, places, result);
  watch_.add_to(outcome_.mapper_s, outcome_.mapper_cpu_s);
  read_next(ahead, next);
  return result;
}

// A change of the loops is reported with the last scan.
void MapRun::report_scans(const Observation& observation, const std::vector<ObservedScan>& places,
                          const MatchResult& match) {
  const bool is_moved = loops_ && !(loops_->correction() == T_closed_front_);
  if (is_moved) T_closed_front_ = loops_->correction();
  for (std::size_t i = 0; i < observation.size(); ++i) {
    const MatchResult of_scan = match_of_scan(match, observation[i], places[i]);
    const bool is_last = places[i].is_last;
    request_.scan_mapped({observation[i].scan, of_scan, T_closed_front_,
                          is_moved && is_last ? loops_->request_keyframes() : ClosedKeyframesSoon(), is_last});
  }
}

// The mapper counts observations, a run counts their scans.
void MapRun::take_observation(const Observation& observation, const std::vector<ObservedScan>& places,
                              const MatchResult& match) {
  for (std::size_t i = 0; i < observation.size(); ++i) {
    MatchResult of_scan = match_of_scan(match, observation[i], places[i]);
    if (!places[i].is_last) {
      of_scan.evaluations = 0;  // the distance of the match counts once
      ++beside_.scans;
      beside_.matched += match.accepted ? 1 : 0;
      beside_.doubtful += match.doubt != Doubt::kNone ? 1 : 0;
      beside_.keyframes += match.merged ? 1 : 0;
    }
    take_match(of_scan, of_scan.T_map_base, observation[i].scan);
    speed_.take(observation[i], of_scan.T_map_base);
    note_stamp(of_scan.stamp_s);
    if (loops_) observed_.put(places[i]);
  }
}

// If a live log breaks off, the map so far is kept.
void MapRun::end_with(const std::exception_ptr& problem) {
  if (!request_.stop_ends_log) std::rethrow_exception(problem);
  try {
    std::rethrow_exception(problem);
  } catch (const Error& error) {
    const bool is_whole = dynamic_cast<const MissingTopic*>(&error) != nullptr;
    if (!is_whole && error.code() != ExitCode::kBadInput && error.code() != ExitCode::kInputOutput) throw;
    outcome_.broken_off = error.code();
    broken_off_ = error.what();
  }
}

// If a stop ends the log, scans read before it are in the kept log, so they are mapped.
void MapRun::map_flat(const Progress& progress) {
  ScanAhead ahead(scans_, has_threads_ && !request_.scan_mapped && are_plain_files(request_.logs));
  NextObservation next;
  if (!stop_()) next.observation = next_unless_stopped(ahead, stop_);
  watch_.add_cpu_to(outcome_.read_cpu_s);
  while (next.observation && (request_.stop_ends_log || !stop_())) {
    Observation observation = *std::exchange(next.observation, std::nullopt);
    for (ScanRecord& scan : observation) speed_.complete(scan);
    std::vector<ObservedScan> places = observation_points_.place(observation);
    const MatchResult result = match(observation, places, ahead, next);
    take_observation(observation, places, result);
    progress(poses_.size(), ahead.progress());
    watch_.add_cpu_to(outcome_.occupancy_cpu_s);
    if (next.problem && !stop_()) end_with(next.problem);
  }
  if (request_.stop_ends_log && poses_.size() > 0) stop_ = [] { return false; };
  outcome_.interrupted = stop_();
  ahead.stop();
  outcome_.mapper_cpu_s -= ahead.cpu_s();  // the thread counted it meanwhile
  outcome_.read_cpu_s += ahead.cpu_s();
}

// Takes poses, keyframes and occupancy map from the path with its loops closed.
void MapRun::close_loops() {
  if (mapper_->statistics().keyframes == 0) return;
  const QueueWork mapping = mapper_->statistics().device;
  ClosedPath path = loops_->close(request_.closing, stop_);
  outcome_.adjusting = mapper_->statistics().device - mapping;
  if (beside_.scans > 0) path = path_of_scans(std::move(path), observed_.all());
  watch_.add_cpu_to(outcome_.loops_cpu_s);
  if (request_.with_map) request_.finishing("the occupancy map");
  for (std::size_t i = 0; i < path.T_map_base.size(); ++i) {
    outcome_.trajectory[i].T_map_base = path.T_map_base[i];
    if (is_kept_[i]) count_in(path.T_map_base[i]);
  }
  LaserShelf::Reader kept(*scans_kept_);
  for (std::size_t i = 0; i < path.T_map_base.size() && occupancy_; ++i) {
    if (is_kept_[i]) occupancy_->add(kept.next(), path.T_map_base[i]);
  }
  scans_kept_.reset();
  watch_.add_cpu_to(outcome_.occupancy_cpu_s);
  const double beside_s = loops_->finish_field();
  outcome_.occupancy_cpu_s -= beside_s;  // the thread counted it meanwhile
  outcome_.loops_cpu_s += beside_s;
  take_closed(std::move(path));
}

}  // namespace gdtslam
