#include "tile_maker.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "engine/mapping/map/scan_beams.hpp"
#include "engine/runs/keyframes/map_of_keyframes.hpp"
#include "engine/runs/mapping/map_run.hpp"

namespace gdtslam {
namespace {

constexpr std::int32_t kPieceTiles = 8;  // along a side, made together

std::int32_t floor_to(std::int32_t cell, std::int32_t side) { return (cell >= 0 ? cell : cell - (side - 1)) / side; }

CellBox hull(const CellBox& a, const CellBox& b) {
  return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
          {std::max(a.end.x, b.end.x), std::max(a.end.y, b.end.y)}};
}

bool touch(const CellBox& a, const CellBox& b) {
  return a.min.x < b.end.x && b.min.x < a.end.x && a.min.y < b.end.y && b.min.y < a.end.y;
}

// Tiles that the keyframe's beams, or the disc around an obstacle, may reach; some more at times.
CellBox tiles_around(const RunKeyframe& keyframe, const MapperConfig& mapper, double free_m) {
  constexpr double kSlack_m = 0.1;
  double range_m = free_m;
  for (const float range : keyframe.laser.ranges_m) {
    if (static_cast<double>(range) < mapper.scan.max_range_m) range_m = std::max(range_m, static_cast<double>(range));
  }
  const LaserScan& scan = keyframe.laser;
  const auto laser_m = [&](std::size_t beam) {
    const Pose2 T_base_laser = is_skewed(scan) ? laser_at_beam(scan, beam) : scan.T_base_laser;
    return (keyframe.T_map_base * T_base_laser).translation();
  };
  const Point2 first_m = laser_m(0);
  const Point2 last_m = laser_m(scan.ranges_m.empty() ? 0 : scan.ranges_m.size() - 1);
  const double reach_m = range_m + (last_m - first_m).norm() + mapper.map.truncation_m + kSlack_m;
  const Point2 around(reach_m, reach_m);
  const CellIndex low = map_cell_at(first_m - around, mapper.map.resolution_m);
  const CellIndex high = map_cell_at(first_m + around, mapper.map.resolution_m);
  return {{floor_to(low.x, kMapTileSide), floor_to(low.y, kMapTileSide)},
          {floor_to(high.x, kMapTileSide) + 1, floor_to(high.y, kMapTileSide) + 1}};
}

bool by_row(const CellIndex& a, const CellIndex& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); }

GridGeometry geometry_of(const CellIndex& place, double resolution_m) {
  return {.resolution_m = resolution_m,
          .origin_x_m = std::int64_t{place.x} * kMapTileSide * resolution_m,
          .origin_y_m = std::int64_t{place.y} * kMapTileSide * resolution_m,
          .width = kMapTileSide,
          .height = kMapTileSide};
}

// The part of the map that lies in the tile; whether anything is known of it.
bool read_states(const OccupancyMap& map, const CellIndex& first, CellStates& states) {
  const CellIndex corner{static_cast<std::int32_t>(std::lround(map.geometry.origin_x_m / map.geometry.resolution_m)),
                         static_cast<std::int32_t>(std::lround(map.geometry.origin_y_m / map.geometry.resolution_m))};
  states = CellStates(std::size_t{kMapTileSide} * kMapTileSide);
  bool is_known = false;
  const CellOffset d = first - corner;
  for (std::int32_t y = std::max(0, -d.dy); y < std::min(kMapTileSide, map.geometry.height - d.dy); ++y) {
    for (std::int32_t x = std::max(0, -d.dx); x < std::min(kMapTileSide, map.geometry.width - d.dx); ++x) {
      const CellState state = map.at({x + d.dx, y + d.dy});
      if (state == CellState::kUnknown) continue;
      states.set(static_cast<std::size_t>(y) * kMapTileSide + static_cast<std::size_t>(x), state);
      is_known = true;
    }
  }
  return is_known;
}

// Those that lie in the tile.
void mark_states(const std::vector<ChangedCell>& cells, CellState state, const CellIndex& first, CellStates& states) {
  for (const ChangedCell& changed : cells) {
    const CellOffset d = changed.cell - first;
    if (d.dx < 0 || d.dy < 0 || d.dx >= kMapTileSide || d.dy >= kMapTileSide) continue;
    states.set(static_cast<std::size_t>(d.dy) * kMapTileSide + static_cast<std::size_t>(d.dx), state);
  }
}

// The part of the distance field that lies in the tile; whether anything is known of it.
bool read_distances(const GlobalField& field, const CellIndex& first, std::vector<std::uint16_t>& distances) {
  distances.resize(std::size_t{kMapTileSide} * kMapTileSide);
  for (std::int32_t y = 0; y < kMapTileSide; ++y) {
    field.read_row(first + CellOffset{0, y},
                   std::span(distances).subspan(static_cast<std::size_t>(y) * kMapTileSide, kMapTileSide));
  }
  return std::any_of(distances.begin(), distances.end(), [cap = field.cap()](std::uint16_t d) { return d != cap; });
}

}  // namespace

TileMaker::TileMaker(const RunKeyframes& run, const MapperConfig& mapper, const OccupancyConfig& occupancy,
                     MapChanges changes, TileParts parts)
    : run_(&run), mapper_(mapper), occupancy_(occupancy), changes_(std::move(changes)), parts_(parts) {
  std::set<std::pair<std::int32_t, std::int32_t>> touched;
  reach_.reserve(run.keyframes.size());
  for (const RunKeyframe& keyframe : run.keyframes) {
    reach_.push_back(tiles_around(keyframe, mapper, occupancy.no_return_free_m));
    const CellBox& tiles = reach_.back();
    for (std::int32_t y = tiles.min.y; y < tiles.end.y; ++y) {
      for (std::int32_t x = tiles.min.x; x < tiles.end.x; ++x) touched.insert({y, x});
    }
  }
  for (const auto& [y, x] : touched) places_.push_back({x, y});
}

std::vector<std::size_t> TileMaker::keyframes_that_touch(const CellBox& tiles) const {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < reach_.size(); ++k) {
    if (touch(reach_[k], tiles)) found.push_back(k);
  }
  return found;
}

void TileMaker::make(std::span<const CellIndex> places, const std::function<void(MapTile&&)>& take,
                     const std::function<void(double)>& progress) const {
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<CellIndex>> pieces;
  for (const CellIndex& place : places) {
    pieces[{floor_to(place.y, kPieceTiles), floor_to(place.x, kPieceTiles)}].push_back(place);
  }
  std::size_t done = 0;
  for (auto& [key, of_piece] : pieces) {
    std::sort(of_piece.begin(), of_piece.end(), by_row);
    CellBox tiles{of_piece.front(), of_piece.front() + CellOffset{1, 1}};
    for (const CellIndex& place : of_piece) tiles = hull(tiles, {place, place + CellOffset{1, 1}});
    make_piece(tiles, of_piece, take, [&](std::size_t made) {
      progress(static_cast<double>(done + made) / static_cast<double>(places.size()));
    });
    done += of_piece.size();
  }
}

OccupancyMap TileMaker::cast(std::span<const std::size_t> keyframes, const std::function<void()>& between) const {
  constexpr std::size_t kBetween = 64;
  OccupancyBuilder builder(occupancy_, occupancy_limits(mapper_));
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    if (i % kBetween == 0) between();
    const RunKeyframe& keyframe = run_->keyframes[keyframes[i]];
    builder.add(keyframe.laser, keyframe.T_map_base);
  }
  return builder.build();
}

// With what changed between the drives of the site; whether anything was known before that.
CellStates TileMaker::states_at(const CellIndex& first, const OccupancyMap& piece, bool& is_known) const {
  CellStates states;
  is_known = read_states(piece, first, states);
  mark_states(changes_.gone, CellState::kFree, first, states);
  mark_states(changes_.appeared, CellState::kOccupied, first, states);
  return states;
}

// Whole scans are merged and cast: what of them lies outside is thrown away.
void TileMaker::make_piece(const CellBox& tiles, std::span<const CellIndex> places,
                           const std::function<void(MapTile&&)>& take,
                           const std::function<void(std::size_t made)>& before) const {
  const std::vector<std::size_t> touching = keyframes_that_touch(tiles);
  if (touching.empty()) return;
  const OccupancyMap occupancy = cast(touching, [&] { before(0); });  // which says, too, where there is a tile
  const std::unique_ptr<SeparateMap> map = map_of_keyframes(*run_, touching, mapper_);
  for (std::size_t k = 0; k < places.size(); ++k) {
    before(k);
    const CellIndex& place = places[k];
    MapTile tile{.place = place,
                 .keyframes = keyframes_that_touch({place, place + CellOffset{1, 1}}).size(),
                 .distances = {},
                 .cap = map->field().cap(),
                 .occupancy = {geometry_of(place, mapper_.map.resolution_m), {}}};
    const CellIndex first{place.x * kMapTileSide, place.y * kMapTileSide};
    bool has_states = false;
    CellStates states = states_at(first, occupancy, has_states);
    if (has_occupancy()) tile.occupancy.cells = std::move(states);
    const bool has_distances = read_distances(map->field(), first, tile.distances);
    if (has_states || has_distances) take(std::move(tile));
  }
}

}  // namespace gdtslam
