// One run of `gdtslam render`: from inputs and options to a file. Thread-safe apart from the files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "options.hpp"
#include "source.hpp"
#include "views.hpp"

namespace gdtslam {

/// Description of the file that was written.
struct RenderResult {
  std::string file;
  OutputKind kind = OutputKind::kPng;
  std::string view;  ///< empty for pages and models
  std::string as;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint64_t frames = 0;     ///< films only
  double film_s = 0.0;          ///< how long it plays
  std::uint64_t points = 0;     ///< drawn, or in the page or model
  std::uint64_t points_of = 0;  ///< before thinning, with floor and ceiling
  std::uint64_t bytes = 0;      ///< size of the file, or of all frames
  std::string renderer;
};

/// The parts that views may use: those of the first source and of the options.
unsigned render_parts(const RenderOptions& options, const std::vector<RenderSource>& sources);

/// Draws and writes. Throws every typed error; nothing is left behind then but the frames of a folder.
RenderResult render(const RenderOptions& options, std::vector<RenderSource>& sources);

}  // namespace gdtslam
