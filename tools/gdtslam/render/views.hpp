// The views of `gdtslam render` as one table for the command, its help and --list-views; the outputs by file name; the
// options with an effect on each; and a run from inputs and options to a file. Thread-safe except for the files.
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

/// Effects of options as bits.
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
inline constexpr unsigned kPlot = 1U << 17U;       ///< lines and words that scale with the pixels
inline constexpr unsigned kFilm = 1U << 18U;       ///< --fps, --seconds
}  // namespace effect

struct RenderView {
  using Draw = Canvas (RenderStudio::*)(const std::optional<PictureSize>&);
  using MakeFilm = std::unique_ptr<Film> (RenderStudio::*)(const PictureSize&, std::size_t);

  std::string_view name;
  std::string_view as;  ///< variant of the view (--as); the first row of a name is the default
  std::string_view doc;
  unsigned needs = 0;    ///< bits of `part`
  unsigned effects = 0;  ///< bits of `effect`
  Draw draw = nullptr;
  int rank = 0;             ///< without --view the view of the highest rank is drawn; 0: never
  MakeFilm film = nullptr;  ///< null: the view does not move
  double film_s = 0.0;      ///< playing time; with --time the longest one
  [[nodiscard]] bool moves() const { return film != nullptr; }
  /// Whether several inputs can be shown side by side.
  [[nodiscard]] bool compares() const { return (effects & effect::kSeveral) != 0; }
  /// "errors --as cdf".
  [[nodiscard]] std::string words() const;
};
const std::vector<RenderView>& render_views();

/// Throws UsageError with the nearest name.
const RenderView& render_view(const std::string& name, const std::string& as);
/// The view of an input if none is named; for a film, the best moving one. Null if no view can be a film.
const RenderView* default_view(unsigned parts, bool is_film);
/// The missing parts that the view needs, "map and 3D cloud", with `joint` between them; empty if there are none.
std::string missing_parts(const RenderView& view, unsigned parts, std::string_view joint = " and ");
/// Names of the views possible with these parts, "map, field".
std::string views_there_are(unsigned parts, bool is_film);

enum class OutputKind : std::uint8_t { kPng, kSvg, kPdf, kMp4, kGif, kFrames, kPage, kGlb, kCloud };

/// Kind by extension, in upper or lower case; a folder, or a name that ends in /, receives the frames of a film. Throws
/// UsageError with the allowed endings.
OutputKind read_output_kind(const std::string& path);
/// "a film in .mp4".
std::string_view to_string(OutputKind kind);

constexpr bool is_film(OutputKind kind) {
  return kind == OutputKind::kMp4 || kind == OutputKind::kGif || kind == OutputKind::kFrames;
}
/// Files without a view: pages, and points or parts for other programs.
constexpr bool has_no_view(OutputKind kind) {
  return kind == OutputKind::kPage || kind == OutputKind::kGlb || kind == OutputKind::kCloud;
}

/// Throws UsageError if the file is also read or written under another option, FileError if its folder is missing.
void require_writable(const RenderOptions& options, const std::string& file);

/// Throws UsageError that names the first option without effect: a mistake, reported before drawing. `view`: null for
/// pages and models; `is_linkage`: the model is a linkage.
void refuse_idle_options(const RenderOptions& options, const RenderView* view, OutputKind output,
                         bool is_linkage = false);

/// Description of the written file.
struct RenderResult {
  std::string file;
  OutputKind kind = OutputKind::kPng;
  std::string view;  ///< empty for pages and models
  std::string as;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint64_t frames = 0;     ///< films only
  double film_s = 0.0;          ///< playing time
  std::uint64_t points = 0;     ///< drawn, or in the page or model
  std::uint64_t points_of = 0;  ///< before thinning, floor and ceiling included
  std::uint64_t bytes = 0;      ///< size of the file, or of all frames
  std::string renderer;
};

/// The parts available to views: from the first source and from the options.
unsigned render_parts(const RenderOptions& options, const std::vector<RenderSource>& sources);

/// Draws and writes. Throws every typed error; then only frames in a folder are left behind.
RenderResult render(const RenderOptions& options, std::vector<RenderSource>& sources);

}  // namespace gdtslam
