// What `gdtslam doctor` is asked for, and the doctor of maps. Thread-safe apart from the files.
#pragma once

#include <string>

#include "tools/gdtslam/shell/recording_options.hpp"
#include "tools/gdtslam/shell/settings_options.hpp"

namespace gdtslam {

struct DoctorOptions {
  std::string log;
  RecordingOptions recording;
  SettingsOptions settings;
  std::string after;     ///< the folder of a run, in place of a log
  std::string picture;   ///< of the run
  bool devices = false;  ///< what can compute here, in place of a log
  bool force = false;
  bool json = false;
};

/// Prints what can compute here, and returns the exit code.
int doctor_of_devices(bool json);

/// Prints what is doubtful in the map of a run, draws it where a picture is asked for, and returns the exit code, which
/// is 0 whatever is doubtful. Throws InputError, FileError, UsageError, UnavailableError.
int doctor_after(const DoctorOptions& options);

}  // namespace gdtslam
