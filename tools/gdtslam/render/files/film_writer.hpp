// Writers of a film's frames: an .mp4 or .gif through the program ffmpeg in its own process, or a folder of PNG files.
// A film appears whole or not at all. One writer belongs to one thread; memory: one frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "gdtslam/drawing/image.hpp"

namespace gdtslam {

enum class FilmKind : std::uint8_t { kMp4, kGif, kFrames };

struct FilmTarget {
  FilmKind kind = FilmKind::kMp4;
  std::string path;  ///< file of the film, or folder of the frames
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double frames_per_s = 25.0;
};

class FilmWriter {
 public:
  FilmWriter() = default;
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;
  /// Without finish() neither film nor process is left behind; frames in a folder stay.
  virtual ~FilmWriter() = default;
  /// Throws FileError, Error with ffmpeg's message if that failed, Error (exit 130) after an interrupt.
  virtual void add(const RgbaImage& frame) = 0;
  /// Ends the film; call it last. Removes further frames of an earlier, longer film. Throws like add().
  virtual void finish() = 0;
};

/// Starts the film, so that a missing program or a file that cannot be written is reported before drawing. Throws
/// UsageError for a target that the format does not allow, UnavailableError if PATH has no ffmpeg, FileError.
std::unique_ptr<FilmWriter> open_film(const FilmTarget& target);

/// File of frame k, counted from 0: frame-0001.png in the folder.
std::string frame_path(const std::string& folder, std::size_t k);

}  // namespace gdtslam
