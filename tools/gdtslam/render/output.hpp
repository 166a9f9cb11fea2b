// The outputs of `gdtslam render`, by the name of the file, and the options that they take notice of. Thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "tools/gdtslam/pictures/options.hpp"
#include "tools/gdtslam/pictures/views.hpp"

namespace gdtslam {

enum class OutputKind : std::uint8_t { kPng, kJpeg, kSvg, kPdf, kMp4, kGif, kFrames, kPage, kGltf, kGlb, kCloud };

/// By extension, in small or capital letters; a name that ends in / or is a folder without such an extension, and a
/// pattern with %04d, take the frames of a film. Throws UsageError with what there is.
OutputKind output_kind_of(const std::string& path);
/// "a film in .mp4".
std::string_view to_string(OutputKind kind);

constexpr bool is_film(OutputKind kind) {
  return kind == OutputKind::kMp4 || kind == OutputKind::kGif || kind == OutputKind::kFrames;
}
/// A still of pixels: of what is drawn by lines and words, too.
constexpr bool is_pixels(OutputKind kind) { return kind == OutputKind::kPng || kind == OutputKind::kJpeg; }
constexpr bool is_gltf(OutputKind kind) { return kind == OutputKind::kGltf || kind == OutputKind::kGlb; }
/// Points or parts for other programs, which no view belongs to.
constexpr bool is_model(OutputKind kind) { return is_gltf(kind) || kind == OutputKind::kCloud; }

/// Throws UsageError where the file is one that is read or another that is written, FileError where it has no folder.
void require_writable(const RenderOptions& options, const std::string& file);

/// Throws UsageError that names the first option that was given and changes nothing: a mistake, said before anything is
/// drawn. `view`: null for pages and models; `is_linkage`: the model is one of a linkage.
void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output,
                         bool is_linkage = false);

}  // namespace gdtslam
