// Where the frames of a film go: an .mp4 or .gif by way of the program ffmpeg, which compresses beside this process, or
// a folder of PNG files. A film appears whole or not at all: ffmpeg writes into a file without a name, which becomes
// the film when all has gone well. One writer belongs to one thread; memory: one frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "gdtslam/drawing/image.hpp"
#include "output.hpp"

namespace gdtslam {

struct FilmTarget {
  OutputKind kind = OutputKind::kMp4;  ///< .mp4, .gif or frames
  std::string path;  ///< a film's file; for frames a folder, or a pattern with one number: out/f%04d.png
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double frames_per_s = 25.0;
  std::string ffmpeg;  ///< the program; empty: `ffmpeg` of PATH
};

class FilmWriter {
 public:
  FilmWriter() = default;
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;
  /// Without finish() no film is left behind, and no process; frames of a folder stay.
  virtual ~FilmWriter() = default;
  /// Throws Error for a frame of another size, FileError, and Error with what ffmpeg said where that failed; exit 130
  /// where an interrupt came while ffmpeg did not take the frame.
  virtual void add(const RgbaImage& frame) = 0;
  /// Ends the film; the last call. Frames of an earlier film beyond the last are removed, and nothing else of the
  /// folder. Throws as add().
  virtual void finish() = 0;
};

/// Begins the film, so that a place that cannot be written or a missing program shows before anything is drawn. Throws
/// UsageError for what the kind cannot hold, UnavailableError where there is no ffmpeg, FileError.
std::unique_ptr<FilmWriter> open_film(const FilmTarget& target);

/// The program as a path, of an absolute folder of PATH where the text has no slash; empty means `ffmpeg`. Throws
/// UnavailableError.
std::string find_ffmpeg(const std::string& given);

/// The file of frame k, counted from 0: frame-0001.png in a folder, or by the pattern. Throws UsageError for a pattern
/// that has not exactly one number or does not end in .png.
std::string frame_path(const std::string& target, std::size_t k);
/// True where the text is a pattern of frames.
bool is_frame_pattern(const std::string& text);

}  // namespace gdtslam
