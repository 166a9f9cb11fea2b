// The views of `gdtslam render`, one table that the command, its help and --list-views read; its outputs, by the name
// of the file; the options that have an effect on them; and one run of it, from inputs and options to a file.
// Thread-safe apart from the files.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/film.hpp"
#include "options.hpp"
#include "source.hpp"

namespace gdtslam {

class RenderStudio;

/// Effects of options, a bit each.
namespace effect {
inline constexpr unsigned kFrom = 1U << 0U;        ///< --from
inline constexpr unsigned kColour = 1U << 1U;      ///< --colour
inline constexpr unsigned kScale = 1U << 2U;       ///< --range
inline constexpr unsigned kColourMap = 1U << 3U;   ///< --colour-map
inline constexpr unsigned kDark = 1U << 4U;        ///< --background dark
inline constexpr unsigned kGround = 1U << 5U;      ///< --background light and none
inline constexpr unsigned kLevels = 1U << 6U;      ///< --hide floor and ceiling
inline constexpr unsigned kPath = 1U << 7U;        ///< --hide path
inline constexpr unsigned kCaption = 1U << 8U;     ///< --hide caption
inline constexpr unsigned kTitle = 1U << 9U;       ///< --title
inline constexpr unsigned kTime = 1U << 10U;       ///< --time
inline constexpr unsigned kPoints = 1U << 11U;     ///< --points
inline constexpr unsigned kLinkage = 1U << 12U;    ///< --linkage
inline constexpr unsigned kDistances = 1U << 13U;  ///< --reference, a cloud
inline constexpr unsigned kReference = 1U << 14U;  ///< --reference, a trajectory
inline constexpr unsigned kRelations = 1U << 15U;  ///< --relations
inline constexpr unsigned kSeveral = 1U << 16U;    ///< more than one input
inline constexpr unsigned kPlot = 1U << 17U;       ///< lines and words, which are scaled up to many pixels
inline constexpr unsigned kFilm = 1U << 18U;       ///< --fps, --seconds
}  // namespace effect

struct RenderView {
  using Draw = Canvas (RenderStudio::*)(const std::optional<PictureSize>&);
  using MakeFilm = std::unique_ptr<Film> (RenderStudio::*)(const PictureSize&, std::size_t);

  std::string_view name;
  std::string_view as;  ///< which of the view's kinds: --as; the first of a name is its default
  std::string_view doc;
  unsigned needs = 0;    ///< bits of `part`
  unsigned effects = 0;  ///< bits of `effect`
  Draw draw = nullptr;
  int rank = 0;             ///< an input is drawn as the view of the highest rank if no view is named; 0: never
  MakeFilm film = nullptr;  ///< null: does not move
  double film_s = 0.0;      ///< how long it plays; with --time, at most
  [[nodiscard]] bool moves() const { return film != nullptr; }
  /// Shows several inputs side by side.
  [[nodiscard]] bool compares() const { return (effects & effect::kSeveral) != 0; }
  /// "errors --as cdf".
  [[nodiscard]] std::string words() const;
};
const std::vector<RenderView>& render_views();

/// Throws UsageError with the nearest name.
const RenderView& render_view(const std::string& name, const std::string& as);
/// The view that an input is drawn as when none is named; the one that moves best for a film. Null if no view can be a
/// film.
const RenderView* default_view(unsigned parts, bool is_film);
/// Names of the needed parts that are missing, "map and 3D cloud", with the joint between them; else empty.
std::string missing_parts(const RenderView& view, unsigned parts, std::string_view joint = " and ");
/// Names of the views that these parts allow, "map, field".
std::string views_there_are(unsigned parts, bool is_film);

enum class OutputKind : std::uint8_t { kPng, kSvg, kPdf, kMp4, kGif, kFrames, kPage, kGlb, kCloud };

/// By extension, in small or capital letters; a folder, or a name that ends in /, takes the frames of a film. Throws
/// UsageError with the endings there are.
OutputKind read_output_kind(const std::string& path);
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
