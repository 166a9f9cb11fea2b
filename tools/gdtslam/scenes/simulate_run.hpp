// Simulates a log from a scene file and writes it with its truth, whole or not at all. The same options give the same
// bytes on every host. Used by the command `simulate`. Cost: one ray per beam, about a microsecond each; memory is the
// log's text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/sim/simulation.hpp"

namespace gdtslam {

struct SimulateOptions {
  std::string scene;  ///< a file, or the name of a scene in one of the folders
  std::vector<std::string> scene_folders;
  std::string output;  ///< the ending selects the format, else CARMEN; .gz compresses
  /// If set, receives the log's lines with the time to send them, and no file is written. Only CARMEN, without nodding.
  /// The first lines have no time.
  std::function<void(std::optional<double> stamp_s, std::string_view lines)> send{};
  std::uint64_t seed = 1;
  std::optional<std::string> laser{};    ///< a preset instead of the scene's laser; mount and height stay
  std::optional<double> scan_rate_hz{};  ///< instead of the scene's
  /// Turns of the laser's mirror, instead of the laser's own. Scans then have the stamp of their first beam, and the
  /// times of the others if the format can carry them.
  std::optional<double> mirror_rate_hz{};
  std::optional<double> speed_m_per_s{};        ///< limit for the robot, instead of the scene's
  std::optional<double> turn_rate_rad_per_s{};  ///< limit for the robot, instead of the scene's
  std::optional<std::string> trajectory{};      ///< a file of waypoints instead of the scene's
  std::optional<std::string> linkage{};         ///< a preset or a linkage file: the mount nods with this linkage
  std::optional<std::string> nod_mode{};        ///< continuous, stop-and-scan or stepped, instead of the scene's
  std::optional<double> crank_rate_hz{};        ///< instead of the scene's
  std::optional<std::int64_t> ticks_per_turn{};
  std::optional<double> elevation_error_rad{};  ///< instead of the scene's
  std::optional<double> sway_tilt_rad{};        ///< instead of the scene's
  std::optional<double> sway_heave_m{};         ///< instead of the scene's
  std::optional<double> noise_m{};              ///< noise of the ranges, instead of the scene's
  std::optional<double> range_resolution_m{};   ///< 0 keeps all digits
  bool is_exact =
      false;  ///< no noise, no rounding and no drop-outs of the laser, 2^30 ticks a turn; the four above win
  bool truth_hits = false;   ///< writes every hit as <log>.truth.ply
  std::string embree_isa{};  ///< forces Embree's instruction set, to test that results stay the same
  std::function<void(std::uint64_t scans, double share)> progress{};
  std::function<bool()> stop{};  ///< returns true to end early; finished scans are written
};

/// The result of a simulation, and its files.
struct SimulateResult : sim::SimulationSummary {
  std::string scene_file;
  std::string log_file;
  std::string truth_file;      ///< <log>.truth.tum; <log> without its endings
  std::string linkage_file;    ///< <log>.linkage.yaml; empty if the laser does not nod, like the next
  std::string elevation_file;  ///< <log>.elevation.csv
  std::string hits_file;       ///< <log>.truth.ply; empty unless requested
  std::size_t triangles = 0;
  std::uint64_t log_bytes = 0;               ///< size of the text before compression
  std::vector<LogReader::Warning> left_out;  ///< data that the format of the log cannot carry
  double clearance_m = 0.0;                  ///< smallest distance from the robot's centre to an obstacle, at most 2 m
  double wall_s = 0.0;
};

/// Throws ConfigError for a scene, FileError for a file, UsageError for an invalid option.
SimulateResult simulate(const SimulateOptions& options);

}  // namespace gdtslam
