// The outputs of `gdtslam render`, by the name of the file, and the options that have an effect on them. Thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "options.hpp"
#include "views.hpp"

namespace gdtslam {

enum class OutputKind : std::uint8_t { kPng, kSvg, kPdf, kMp4, kGif, kFrames, kPage, kGlb, kCloud };

/// By extension, in small or capital letters; a folder, or a name that ends in /, takes the frames of a film. Throws
/// UsageError with the endings there are.
OutputKind output_kind_of(const std::string& path);
/// "a film in .mp4".
std::string_view to_string(OutputKind kind);

constexpr bool is_film(OutputKind kind) {
  return kind == OutputKind::kMp4 || kind == OutputKind::kGif || kind == OutputKind::kFrames;
}
/// Files that no view belongs to: points or parts for other programs, and pages.
constexpr bool has_no_view(OutputKind kind) {
  return kind == OutputKind::kPage || kind == OutputKind::kGlb || kind == OutputKind::kCloud;
}

/// Throws UsageError if the file is one that is read or another that is written, FileError if it has no folder.
void require_writable(const RenderOptions& options, const std::string& file);

/// Throws UsageError that names the first option that was given and changes nothing: a mistake, reported before
/// anything is drawn. `view`: null for pages and models; `is_linkage`: the model is one of a linkage.
void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output,
                         bool is_linkage = false);

}  // namespace gdtslam
