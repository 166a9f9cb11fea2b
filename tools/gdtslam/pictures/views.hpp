// The views of `gdtslam render`: one table that the command, its help and --list-views read. Thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"
#include "gdtslam/viewer/film.hpp"
#include "source.hpp"

namespace gdtslam {

class RenderStudio;

/// What an option changes; a set of them as bits.
namespace effect {
inline constexpr unsigned kSize = 1U << 0U;        ///< --size
inline constexpr unsigned kPngSize = 1U << 1U;     ///< likewise, of .png: lines have a size of their own
inline constexpr unsigned kColour = 1U << 2U;      ///< --colour, --range
inline constexpr unsigned kColourMap = 1U << 3U;   ///< --colour-map
inline constexpr unsigned kCamera = 1U << 4U;      ///< --camera, of stills
inline constexpr unsigned kPoint = 1U << 5U;       ///< --point-size, --with-ceiling
inline constexpr unsigned kDark = 1U << 6U;        ///< --dark
inline constexpr unsigned kLight = 1U << 7U;       ///< --light
inline constexpr unsigned kPage = 1U << 8U;        ///< --transparent, --no-caption
inline constexpr unsigned kLevels = 1U << 9U;      ///< --no-floor, --no-ceiling
inline constexpr unsigned kPath = 1U << 10U;       ///< --no-path
inline constexpr unsigned kTitle = 1U << 11U;      ///< --title
inline constexpr unsigned kStretch = 1U << 12U;    ///< --from, --to
inline constexpr unsigned kDistances = 1U << 13U;  ///< --reference, a cloud
inline constexpr unsigned kErrors = 1U << 14U;     ///< --reference, a trajectory; --relations, --angle
inline constexpr unsigned kCells = 1U << 15U;      ///< --at, --cells, --squared
inline constexpr unsigned kPoints = 1U << 16U;     ///< --points
inline constexpr unsigned kFilm = 1U << 17U;       ///< --fps, --frames, --seconds
inline constexpr unsigned kFfmpeg = 1U << 18U;     ///< --ffmpeg
inline constexpr unsigned kReference = 1U << 20U;  ///< --reference, a trajectory
inline constexpr unsigned kScale = 1U << 21U;      ///< --range
inline constexpr unsigned kSeveral = 1U << 22U;    ///< more than one input
inline constexpr unsigned kLinkage = 1U << 23U;    ///< --linkage
inline constexpr unsigned kVector = 1U << 19U;     ///< -o .svg and .pdf: lines and words, which grow without blur
}  // namespace effect

struct RenderView {
  using Draw = Canvas (RenderStudio::*)(const std::optional<PictureSize>&);
  using MakeFilm = std::unique_ptr<Film> (RenderStudio::*)(const PictureSize&, std::size_t);

  std::string_view name;
  std::string_view doc;
  unsigned needs = 0;    ///< bits of `part`
  unsigned effects = 0;  ///< bits of `effect`
  Draw draw = nullptr;
  int rank = 0;             ///< of what an input is drawn as when no view is named the highest; 0: never
  MakeFilm film = nullptr;  ///< null: does not move
  double film_s = 0.0;      ///< how long it plays; where --from and --to have an effect, at most
  [[nodiscard]] bool moves() const { return film != nullptr; }
  /// Shows several inputs side by side.
  [[nodiscard]] bool compares() const { return (effects & effect::kSeveral) != 0; }
};
const std::vector<RenderView>& render_views();

/// Throws UsageError with the nearest name.
const RenderView& render_view(const std::string& name);
/// The view that an input is drawn as when none is named; the one that moves best for a film. Nothing where no view can
/// be a film.
const RenderView* default_view(unsigned parts, bool is_film);
/// What the view lacks of these parts, "map and 3D cloud", with these words between them; empty when nothing.
std::string missing_parts(const RenderView& view, unsigned parts, std::string_view joint = " and ");
/// Names of the views that these parts allow, "map, field, distance".
std::string views_there_are(unsigned parts, bool is_film);

}  // namespace gdtslam
