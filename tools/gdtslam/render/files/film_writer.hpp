// Writers of a film's frames: an .mp4 or .gif through the program ffmpeg, which compresses beside this process, or a
// folder of PNG files. A film appears whole or not at all. One writer belongs to one thread; memory: one frame.
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
  std::string path;  ///< the film's file, or the folder of the frames
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double frames_per_s = 25.0;
};

class FilmWriter {
 public:
  FilmWriter() = default;
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;
  /// Without finish() no film is left behind, and no process; frames in a folder stay.
  virtual ~FilmWriter() = default;
  /// Throws FileError, Error with what ffmpeg said if that failed, Error (exit 130) if an interrupt came.
  virtual void add(const RgbaImage& frame) = 0;
  /// Ends the film; the last call. Frames of an earlier, longer film that follow the last one are removed. Throws as
  /// add().
  virtual void finish() = 0;
};

/// Begins the film, so that a missing program or a file that cannot be written shows before anything is drawn. Throws
/// UsageError for what the kind cannot hold, UnavailableError if PATH has no ffmpeg, FileError.
std::unique_ptr<FilmWriter> open_film(const FilmTarget& target);

/// The file of frame k, counted from 0: frame-0001.png in the folder.
std::string frame_path(const std::string& folder, std::size_t k);

}  // namespace gdtslam
