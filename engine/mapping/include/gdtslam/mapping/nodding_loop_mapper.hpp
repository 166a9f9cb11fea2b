// The 3D system of figure 10 with loops closed: horizontal scans go through a LoopMapper as they come, and once the log
// has ended and its loops are closed, all scans are placed between the corrected fixes, and their beams become points.
// Frames: map. Memory: every scan until it is placed, 4 bytes a beam and some 300 bytes a scan, beside that of the
// LoopMapper. One mapper belongs to one thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gdtslam/mapping/mapper.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"

namespace gdtslam {

/// Maps the scans of a laser that nods; poses and points come at the end. Who needs them at once takes NoddingMapper.
class NoddingLoopMapper {
 public:
  using PoseSink = NoddingMapper::PoseSink;
  /// As NoddingMapper. The mapper gets the horizontal scans from here alone.
  NoddingLoopMapper(const NoddingConfig& config, const NoddingScanner& scanner, LoopMapper& mapper, Backend& backend,
                    CloudSink& cloud, PoseSink poses, MapperOptions on_failure = {});
  ~NoddingLoopMapper();
  /// The next scan in log order. Throws as LoopMapper does.
  void process(NoddingScan scan);
  /// To be called once, when the log has ended: closes the loops as LoopMapper::close() does, then gives poses and
  /// points of all scans. Scans of the result are those whose poses were given, in that order; the covariance between
  /// two fixes is linear by their number, before the first and behind the last it is that of the fix. Where stop() is
  /// true before the loops are closed, the path is that of the front end, and all scans get their points; where it
  /// becomes true later, the scans that are left get poses and no points. Throws InputError when no scan was
  /// horizontal, with the range of elevations seen and what to do, and DeviceError as NoddingMapper does.
  ClosedPath close(const LoopMapper::Progress& progress, const std::function<bool()>& stop);
  [[nodiscard]] const NoddingStatistics& statistics() const;
  [[nodiscard]] const std::vector<std::string>& warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gdtslam
