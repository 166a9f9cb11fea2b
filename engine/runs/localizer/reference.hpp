// What `gdtslam localize` knows of scans beforehand: their true poses, and which of them went into the map. Frame: map.
// Thread-safe once made; O(log n) a scan.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/runs/folder/run_reader.hpp"
#include "gdtslam/mapping/evaluation.hpp"

namespace gdtslam {

/// Times of the scans that a run merged into its map.
class MergedScans {
 public:
  /// Throws InputError where the run does not tell them, or its files are missing.
  MergedScans(const RunReader& run, double within_s);
  /// Whether one was merged at most within_s() before or after.
  [[nodiscard]] bool are_near(double stamp_s) const;
  [[nodiscard]] double within_s() const { return within_s_; }
  [[nodiscard]] std::size_t count() const { return stamps_s_.size(); }

 private:
  double within_s_;
  std::vector<double> stamps_s_;  // ascending
};

/// What they are, for people: "that went into the map", "within 0.5 s of one that went into the map".
std::string near_text(const MergedScans& merged);

/// True poses of scans, in the map's frame.
class LocalizeTruth {
 public:
  /// Throws InputError, FileError.
  explicit LocalizeTruth(const std::string& file);
  /// Moves all poses so that they lie best on the run's trajectory, whose frame they are in from then on. Throws
  /// InputError where fewer than two stamps agree.
  void align(const RunReader& run);

  /// The pose of the scan with that stamp; none where two poses have it, between which a clock stepped back.
  [[nodiscard]] std::optional<Pose2> find(double stamp_s) const;
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::size_t count() const { return poses_.size(); }
  /// Of its poses, those whose stamps two stretches have.
  [[nodiscard]] std::size_t count_repeated() const;
  [[nodiscard]] bool is_aligned() const { return is_aligned_; }

 private:
  std::string file_;
  Trajectory poses_;
  PosesByStamp by_stamp_;
  RepeatedStamps repeated_;
  bool is_aligned_ = false;
};

/// The run folder that a map belongs to: itself, or the folder of its gdt.yaml; none where that is none.
std::optional<std::string> run_folder_of(const std::string& map);
/// The same as a run. Throws InputError, with what it was
/// needed for, where it is none.
RunReader run_of_map(const std::string& map, const std::string& purpose);

/// How well a scan of the mapped place fits: mean distances of its points to the map's obstacles.
struct FitLimit {
  /// The largest comes from an option, from 99 of 100 of the run's own scans, or from the size of the map's cells.
  enum class Source : std::uint8_t { kOption, kRun, kResolution };
  double distance_m = 0.0;  ///< the largest that is a good fit
  Source source = Source::kOption;
  double usual_m = 0.0;  ///< the median
};
/// From the mean distances that the run's own scans leave in the finished map. Two cells are always a good fit: the
/// most that rounding to cells in the scan and in the map can account for, while scans that a map was made of fit it
/// better than others. Without scans one cell is usual.
FitLimit fit_limit_of(std::vector<double> own_m, double resolution_m);

}  // namespace gdtslam
