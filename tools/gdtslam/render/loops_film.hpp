// The film of the loops of a run closing, and the picture of its path before and after. Frame: map. One object belongs
// to one thread.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>

#include "gdtslam/drawing/map_picture.hpp"
#include "gdtslam/viewer/film.hpp"
#include "loops_path.hpp"
#include "source.hpp"

namespace gdtslam {

/// The path is driven as the front end measured it. Where loops lead back, the graph is solved with those that are
/// known by then, the picture bends and the loop lights up; at the end comes the adjusted path, and the map. Walls are
/// what the map has around each place: scans are not kept. `source` needs map, trajectory and replay, and must outlive
/// the film. `look`: without a title there are no words. Throws as read_run_graph() does.
std::unique_ptr<Film> loops_film(RenderSource& source, const MapLook& look, const PictureSize& size,
                                 const LoopsFilmLength& length);

/// Side by side, or one above the other where the map is wide, to one scale: path and walls as the front end measured
/// them, and as they are with the loops. Throws as loops_film() does.
Canvas loops_before_and_after(RenderSource& source, const MapLook& look, const std::optional<PictureSize>& wanted);

}  // namespace gdtslam
