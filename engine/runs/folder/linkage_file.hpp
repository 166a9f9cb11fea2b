// Linkage files: how a laser nods, as YAML (`gdtslam_linkage: 1`): bars, assembly, encoder, elevation, mount, laser
// (docs/formats.md). Every message has file and line. Thread-safe; linear in the file.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/calib/sweep_model.hpp"
#include "gdtslam/core/units.hpp"

namespace gdtslam {

/// Uncertainty of a parameter of the model, from `calibrate`. Names and units are those of calib::CalibratedParameter,
/// without surfaces: crank, coupler, rocker, ground, lever.forward, lever.up in m; zero, offset, sensor.roll,
/// sensor.yaw in rad.
struct ParameterSigma {
  std::string name;
  double sigma = 0.0;
  friend bool operator==(const ParameterSigma&, const ParameterSigma&) = default;
};

struct LinkageFile {
  calib::SweepModel model;
  std::vector<ParameterSigma> uncertainty;  ///< in the file's order; empty if the file states none
};

/// Throws FileError if the file cannot be read, else ConfigError with file, line, fault and advice.
LinkageFile read_linkage_file(const std::string& file);
/// The same from text; messages name `file`.
LinkageFile read_linkage_text(const std::string& text, const std::string& file);
/// The model alone.
calib::SweepModel read_linkage(const std::string& file);
/// Reads a preset by name, else a file. Throws like read_linkage(); FileError with the nearest preset if it is neither.
calib::SweepModel resolve_linkage(const std::string& name_or_path);

/// The file that resolve_linkage() would read; empty for a preset's name.
std::string linkage_file_of(const std::string& name_or_path);

/// Text of a file that reads back as the same model, bit for bit. Leaves out sigmas of names that are not parameters of
/// the model (a wall's distance).
std::string linkage_text(const calib::SweepModel& model, const std::vector<ParameterSigma>& uncertainty = {});
/// Atomic. Throws FileError.
void write_linkage(const std::string& file, const calib::SweepModel& model,
                   const std::vector<ParameterSigma>& uncertainty = {});

/// A calibrated parameter whose uncertainty a linkage file may state.
struct LinkageParameter {
  const char* name;  ///< name in calib::CalibratedParameter
  Unit unit;
};

inline constexpr std::array<LinkageParameter, 10> kLinkageParameters{{{"crank", Unit::kMetre},
                                                                      {"coupler", Unit::kMetre},
                                                                      {"rocker", Unit::kMetre},
                                                                      {"ground", Unit::kMetre},
                                                                      {"zero", Unit::kRadian},
                                                                      {"offset", Unit::kRadian},
                                                                      {"lever.forward", Unit::kMetre},
                                                                      {"lever.up", Unit::kMetre},
                                                                      {"sensor.roll", Unit::kRadian},
                                                                      {"sensor.yaw", Unit::kRadian}}};

/// LOG without .gz (.bz2, .xz, .zst) and the ending of its format (.log, .clf, .csv, .jsonl, .mcap, .bag, .db3, /),
/// with `suffix`: the name of a file that belongs to a log.
std::string sidecar_path(const std::string& log, const std::string& suffix);
inline constexpr const char* kLinkageSidecar = ".linkage.yaml";
/// sidecar_path(log, kLinkageSidecar) if that file exists; else empty, as for the standard input.
std::string linkage_sidecar(const std::string& log);

}  // namespace gdtslam
