// Maps logs of a nodding laser: the 2D system on the horizontal scans, poses of the scans between, the 3D cloud, and
// how well consecutive sweeps agree. Used by the command map. One run belongs to one thread.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "cloud_output.hpp"
#include "engine/runs/streams/nodding_stream.hpp"
#include "engine/runs/streams/scan_stream.hpp"
#include "gdtslam/calib/nod_track.hpp"
#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/mapping/nodding_mapper.hpp"
#include "map_run.hpp"
#include "sweep_check.hpp"

namespace gdtslam {

/// What a nodding log needs besides a MapJob.
struct NoddingJob {
  NodKind kind = NodKind::kEncoder;
  calib::SweepModel model;
  std::string linkage;  ///< where the model comes from: a preset's name or a file
  NoddingConfig nodding;
  calib::NodTrackLimits limits;
  SweepCheckConfig check;
};

class NoddingRun {
 public:
  /// Points go to `cloud`, where there is one.
  NoddingRun(const MapJob& job, const NoddingJob& nodding, Backend& backend, ScanStream scans,
             std::unique_ptr<CloudOutput> cloud);

  /// As MapRun::run; throws InputError also when no scan is horizontal.
  MapOutcome run(const MapRun::Progress& progress, const std::function<bool()>& stop);
  [[nodiscard]] const Mapper& mapper() const { return mapper_; }
  [[nodiscard]] const NoddingOutcome& outcome() const { return nodding_outcome_; }

 private:
  /// Sends each point on and keeps what the check of the sweeps needs.
  class Splitter : public CloudSink {
   public:
    Splitter(CloudOutput* cloud, SweepSampler& sampler) : cloud_(cloud), sampler_(sampler) {}
    void add(std::span<const CloudPoint> points) override;

   private:
    CloudOutput* cloud_;
    SweepSampler& sampler_;
  };

  void take(const NoddingPose& pose, const NoddingScan& scan, MapOutcome& outcome);
  void map_all(const MapRun::Progress& progress, const std::function<bool()>& stop, MapOutcome& outcome);
  void finish(MapOutcome& outcome);

  MapJob job_;
  NoddingScanner scanner_;
  ScanStream scans_;
  NoddingStream stream_;
  Mapper mapper_;
  OccupancyBuilder occupancy_;
  std::unique_ptr<CloudOutput> cloud_;
  SweepSampler sampler_;
  Splitter splitter_;
  MapOutcome* outcome_in_hand_ = nullptr;
  NoddingMapper nodding_;
  NoddingOutcome nodding_outcome_;
};

/// The scanner of a log: linkage and mount of the model, or its mount alone where the elevation itself was measured.
NoddingScanner scanner_of(const calib::SweepModel& model, NodKind kind);

}  // namespace gdtslam
