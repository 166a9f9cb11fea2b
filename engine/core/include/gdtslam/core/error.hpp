// Typed errors. A library throws one of these for bad input, a bad configuration, a device or a file that fails;
// programming errors are asserts and expected outcomes are values. The command maps each type to its exit code.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace gdtslam {

/// Exit codes of the command, after sysexits.h where one fits.
enum class ExitCode : int {
  kDone = 0,
  kFailed = 1,
  kUsage = 2,
  kBadInput = 65,
  kUnavailable = 69,
  kInputOutput = 74,
  kBadConfig = 78,
  kInterrupted = 130,
};

/// Base of every error that a user can cause or meet; what() is one line that says what is wrong and what to do.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

/// A place in a file; line 0 means the file as a whole.
struct FilePosition {
  std::string file;
  std::uint64_t line = 0;
};

/// "file:line: message", or "file: message" if no line is known.
std::string located(const FilePosition& position, const std::string& message);

/// Input data that cannot be used (exit 65).
class InputError : public Error {
 public:
  InputError(const FilePosition& position, const std::string& message)
      : Error(ExitCode::kBadInput, located(position, message)), has_position_(true) {}
  explicit InputError(const std::string& message) : Error(ExitCode::kBadInput, message) {}
  /// Without a position, the caller that knows the file of the data has to name it.
  [[nodiscard]] bool has_position() const noexcept { return has_position_; }

 private:
  bool has_position_ = false;
};

/// A configuration that cannot be used (exit 78).
class ConfigError : public Error {
 public:
  ConfigError(const FilePosition& position, const std::string& message)
      : Error(ExitCode::kBadConfig, located(position, message)) {}
  explicit ConfigError(const std::string& message) : Error(ExitCode::kBadConfig, message) {}
};

/// A file that cannot be read or written (exit 74).
class FileError : public Error {
 public:
  FileError(const std::string& file, const std::string& message)
      : Error(ExitCode::kInputOutput, located({file, 0}, message)) {}
};

/// A requested device, display or helper program is missing (exit 69).
class UnavailableError : public Error {
 public:
  explicit UnavailableError(const std::string& message) : Error(ExitCode::kUnavailable, message) {}
};

/// A call of a device's driver that failed while running (exit 1): the device is lost or out of memory and must not be
/// used any more. Data on the host is intact, so the work can continue elsewhere.
class DeviceError : public Error {
 public:
  /// The name of the call and the code that it returned, for example "vkQueueSubmit", "ErrorDeviceLost".
  DeviceError(const std::string& device, const std::string& call, const std::string& result)
      : Error(ExitCode::kFailed, device + ": " + call + " gave " + result), call_(call), result_(result) {}
  [[nodiscard]] const std::string& call() const noexcept { return call_; }
  [[nodiscard]] const std::string& result() const noexcept { return result_; }

 private:
  std::string call_;
  std::string result_;
};

/// A command line that makes no sense (exit 2).
class UsageError : public Error {
 public:
  explicit UsageError(const std::string& message) : Error(ExitCode::kUsage, message) {}
};

}  // namespace gdtslam
