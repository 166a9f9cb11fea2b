#include "search.hpp"

#include <algorithm>
#include <cmath>

#include "device.hpp"
#include "engine/compute/kernels/host_kernels.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/mapping/scan_points.hpp"

namespace gdtslam {
namespace {

constexpr std::uint64_t kMostTopBoxes = 150000;
constexpr std::int32_t kTopSpacingBits = 3;  // spacing at which small searches begin
constexpr std::uint32_t kWideTile = 16;
constexpr std::uint32_t kWideTileRows = 4;
constexpr std::size_t kHostTiles = 256;  // tiles at once: their sums stay in the cache
// Number of halvings of boxes below the narrowest fields, from half a cell to 1/64 of one: for smaller boxes the
// rounding loss exceeds their width.
constexpr std::int32_t kParts = 6;
// Number of those levels that use a field of minorants first.
constexpr std::int32_t kWideLevels = 2;
constexpr std::int32_t kWideAbove = 1;    // number of levels with dilated fields that do so
constexpr float kLeastReference = 40.0F;  // cells
// Share of the mean range, measured on Intel's map: finer angles cost more boxes, coarser ones give blunter bounds.
constexpr float kReferenceShare = 1.4F;
// Slack for float32 in the poses of boxes and their angles.
constexpr float kAngleSlack = 1.0e-6F;
constexpr double kFloatUnit = 1.0 / 16777216.0;  // 2^-24
// Half widths of a window below which it counts as narrow: twice that of the smallest boxes and their grid, cells, and
// some units of float32, radians.
constexpr double kNarrow_cells = 1.0 / 16.0;
constexpr double kNarrow_rad = 1.0e-5;

std::uint32_t divided_up(std::uint32_t value, std::uint32_t by) { return (value + by - 1) / by; }

float point_range(const PointCells& point) { return std::sqrt(point.x * point.x + point.y * point.y); }

}  // namespace

CertifiedSearch::CertifiedSearch(const CertifiedMap& map, std::span<const PointCells> points, const PoseWindow& window,
                                 const CertifiedOptions& options)
    : map_(map), points_(points.begin(), points.end()), window_(window), options_(options) {
  const FieldView& field = map.field();
  const double resolution_m = field.resolution_m;
  is_narrow_x_ = window.half_x_m < kNarrow_cells * resolution_m;
  is_narrow_y_ = window.half_y_m < kNarrow_cells * resolution_m;
  is_narrow_theta_ = window.half_theta_rad < kNarrow_rad;
  if (is_narrow_theta_) window_.centre.theta_rad = wrap_angle(window.centre.theta_rad);
  const CellIndex cell = map_cell_at(window.centre.translation(), resolution_m);
  anchor_ = {aligned_down(cell.x), aligned_down(cell.y)};
  // Rounded to a grid of 1/64 cell, so that the corners of all boxes are exact in float32.
  const auto on_grid = [](double cells) { return static_cast<float>(std::round(cells * 64.0) / 64.0); };
  centre_ = {on_grid(window.centre.x_m / resolution_m - anchor_.x),
             on_grid(window.centre.y_m / resolution_m - anchor_.y),
             static_cast<float>(wrap_angle(window.centre.theta_rad))};
  const auto reach = [&](double half_m) { return static_cast<float>(half_m / resolution_m + 1.0 / 64.0); };
  half_x_ = reach(window.half_x_m);
  half_y_ = reach(window.half_y_m);
  half_theta_ = static_cast<float>(std::min(window.half_theta_rad, kPi)) + kAngleSlack;
  gap_ = static_cast<std::uint32_t>(
      std::min(4.0e9, std::floor(options.gap_m / resolution_m * 256.0 * static_cast<double>(points_.size()))));
  cost_params_ = {.width = field.width,
                  .height = field.height,
                  .stride = field.stride,
                  .anchor_x = anchor_.x - field.first_cell.x,
                  .anchor_y = anchor_.y - field.first_cell.y,
                  .point_count = static_cast<std::uint32_t>(points_.size()),
                  .cap = field.cap};
  if (options.prior) {
    const CellPose mean = to_cells(options.prior->mean);
    prior_ = {mean.x, mean.y, mean.theta, options.prior->weight_xy, options.prior->weight_theta, options.prior->limit};
  }
  began_ = std::chrono::steady_clock::now();
  prepare_points();
  choose_levels();
}

// Points stay in beam order, in which far and near ones alternate; no result depends on it. The slack covers the
// float32 error of the farthest point in the farthest corner of the window.
void CertifiedSearch::prepare_points() {
  double sum = 0.0;
  float farthest = 0.0F;
  for (const PointCells& point : points_) {
    sum += static_cast<double>(point_range(point));
    farthest = std::max(farthest, point_range(point));
  }
  reference_ =
      std::max(kLeastReference, kReferenceShare * static_cast<float>(sum / static_cast<double>(points_.size())));
  const double coordinates =
      static_cast<double>(farthest) + static_cast<double>(half_x_ + half_y_) + 2.0 * kBoundAlignment;
  slack_ = static_cast<float>(1.0 / 512.0 + 24.0 * kFloatUnit * coordinates);
}

std::uint64_t CertifiedSearch::boxes_at(std::size_t level) const {
  const BoundLevel& fields = map_.bounds().levels()[level];
  const double spacing = std::ldexp(1.0, fields.spacing_bits);
  const double angles = std::ceil(static_cast<double>(half_theta_) / (0.5 * spacing / static_cast<double>(reference_)));
  return static_cast<std::uint64_t>(std::ceil(2.0 * static_cast<double>(half_x_) / spacing) *
                                    std::ceil(2.0 * static_cast<double>(half_y_) / spacing) * std::max(1.0, angles));
}

// Starts with the narrowest boxes that are not too many, but none narrower than is useful.
void CertifiedSearch::choose_levels() {
  const std::span<const BoundLevel> levels = map_.bounds().levels();
  first_level_ = 0;
  while (levels[first_level_].spacing_bits > kTopSpacingBits && boxes_at(first_level_ + 1) <= kMostTopBoxes)
    ++first_level_;
  field_levels_ = static_cast<std::int32_t>(levels.size() - first_level_);
  top_angles_ = static_cast<std::uint32_t>(
      std::max(1.0F, std::ceil(half_theta_ * reference_ / std::ldexp(0.5F, levels[first_level_].spacing_bits))));
  top_angle_ = half_theta_ / static_cast<float>(top_angles_);
  for (std::int32_t level = 0; level <= field_levels_ + kParts; ++level) {
    half_widths_.push_back(has_fields(level) ? std::ldexp(0.5F, fields(level).spacing_bits)
                                             : std::ldexp(0.5F, field_levels_ - level));
    half_angles_.push_back(is_narrow_theta_ ? top_angle_ : std::ldexp(top_angle_, -level));
  }
  bound_points_.resize(static_cast<std::size_t>(field_levels_));
  for (std::int32_t level = 0; level < field_levels_; ++level) {
    const BoundLevel& f = fields(level);
    const float angle = half_angle(level) + kAngleSlack;
    const float around = half_width(level) + std::ldexp(0.5F, f.sample_bits()) + slack_;
    for (const PointCells& point : points_) {
      const float needed = around + point_range(point) * angle;
      std::size_t k = 0;
      while (k < BoundLevel::kDilations && static_cast<float>(f.dilation_cells[k]) < needed) ++k;
      // A point beyond the widest dilation does not count, which keeps the bound low.
      if (k < BoundLevel::kDilations) {
        bound_points_[static_cast<std::size_t>(level)].push_back({point.x, point.y, f.first_sample[k]});
      }
    }
  }
  for (std::int32_t level = field_levels_ - kWideAbove; has_wide_minorant(level); ++level) choose_reaches(level);
}

const BoundLevel& CertifiedSearch::fields(std::int32_t level) const {
  return map_.bounds().levels()[first_level_ + static_cast<std::size_t>(level)];
}

// Each point takes the narrowest field that covers its motion within the box.
void CertifiedSearch::choose_reaches(std::int32_t level) {
  const MinorantLevels& fields = map_.bounds().minorants();
  std::vector<BoundPoint>& chosen = wide_points_.emplace_back();
  const float around = half_width(level) + 0.5F + slack_;
  for (const PointCells& point : points_) {
    const float needed = around + point_range(point) * (half_angle(level) + kAngleSlack);
    std::size_t k = 0;
    while (k < fields.kReaches.size() && static_cast<float>(fields.kReaches[k]) < needed) ++k;
    const bool near = std::fabs(point.x) + std::fabs(point.y) < 0.7F * PoseMinorant::kFarthest;  // at any heading
    if (near && k < fields.kReaches.size()) chosen.push_back({point.x, point.y, fields.first_word[k]});
  }
}

// Covers the window with boxes of the top level and bounds them all.
void CertifiedSearch::open_window() {
  const float spacing = 2.0F * half_width(0);
  const auto count = [&](float half) {
    return static_cast<std::uint32_t>(std::max(1.0F, std::ceil(2.0F * half / spacing)));
  };
  const auto low = [&](float centre, std::uint32_t n) { return centre - 0.5F * static_cast<float>(n - 1) * spacing; };
  const std::uint32_t columns = count(half_x_);
  const std::uint32_t rows = count(half_y_);
  const std::size_t batch = map_.device() != nullptr ? DeviceBounds::kMostTiles : kHostTiles;
  std::vector<PoseCandidate> corners;
  const auto bound = [&] {
    bound_tiles(0, corners, kWideTile, kWideTileRows, 0);
    corners.clear();
  };
  for (std::uint32_t t = 0; t < top_angles_; ++t) {
    const float theta = (centre_.theta - half_theta_) + (2.0F * static_cast<float>(t) + 1.0F) * top_angle_;
    for (std::uint32_t j = 0; j < divided_up(rows, kWideTileRows); ++j) {
      for (std::uint32_t i = 0; i < divided_up(columns, kWideTile); ++i) {
        corners.push_back({low(centre_.x, columns) + static_cast<float>(i * kWideTile) * spacing,
                           low(centre_.y, rows) + static_cast<float>(j * kWideTileRows) * spacing, theta, 0});
        if (corners.size() == batch) bound();
      }
    }
  }
  bound();
}

// The sums of tiles of a level; on the device if there is one and the tiles are many.
void CertifiedSearch::sum_tiles(const PoseBounds::Params& params, std::int32_t level,
                                std::span<const PoseCandidate> corners) {
  const std::vector<BoundPoint>& points = bound_points_[static_cast<std::size_t>(level)];
  const std::size_t map_level = first_level_ + static_cast<std::size_t>(level);
  sums_.resize(corners.size() * params.tile_width * params.tile_height);
  if (map_.device() != nullptr && map_.device()->takes(params, map_level, corners.size())) {
    map_.device()->sum(params, map_level, points, corners, sums_);
    return;
  }
  pose_bounds_host(map_.isa(), params, fields(level).samples.data(), points.data(), corners.data(),
                   static_cast<std::uint32_t>(corners.size()), sums_.data());
}

// Bounds of tiles of boxes of a level by its dilated fields; boxes that may matter are appended.
void CertifiedSearch::bound_tiles(std::int32_t level, std::span<const PoseCandidate> corners, std::uint32_t tile_width,
                                  std::uint32_t tile_height, std::uint32_t known_bound) {
  const BoundLevel& f = fields(level);
  const PoseBounds::Params params{
      .width = f.width,
      .height = f.height,
      .first_column = ((anchor_.x - f.origin.x) >> f.spacing_bits) + BoundLevel::kMargin,
      .first_row = ((anchor_.y - f.origin.y) >> f.spacing_bits) + BoundLevel::kMargin,
      .phase_bits = static_cast<std::uint32_t>(f.phase_bits),
      .samples_per_cell = std::ldexp(1.0F, -f.sample_bits()),
      .point_count = static_cast<std::uint32_t>(bound_points_[static_cast<std::size_t>(level)].size()),
      .last_field = f.first_sample.back(),
      .tile_width = tile_width,
      .tile_height = tile_height};
  const std::size_t in_tile = std::size_t{tile_width} * tile_height;
  sum_tiles(params, level, corners);
  const float spacing = 2.0F * half_width(level);
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const PoseCandidate& corner = corners[i / in_tile];
    const std::size_t place = i % in_tile;
    const std::size_t row = place / tile_width;
    OpenBox box{.terms = std::max(sums_[i] * map_.bounds().unit(), known_bound),
                .level = level,
                .centre = {corner.x + static_cast<float>(place % tile_width) * spacing,
                           corner.y + static_cast<float>(row) * spacing, corner.theta}};
    if (!matters(box)) continue;
    ++boxes_;
    keep(box);
  }
}

// True if a pose in the box may count.
bool CertifiedSearch::matters(const OpenBox& box) const {
  const float w = half_width(box.level);
  const float off_x = std::fabs(box.centre.x - centre_.x);
  const float off_y = std::fabs(box.centre.y - centre_.y);
  if (off_x - w > half_x_ || off_y - w > half_y_) return false;
  return std::none_of(options_.excluded.begin(), options_.excluded.end(),
                      [&](const ExcludedPoses& excluded) { return is_within(box, excluded); });
}

// The whole box is excluded if its farthest corner is.
bool CertifiedSearch::is_within(const OpenBox& box, const ExcludedPoses& excluded) const {
  const float w = half_width(box.level);
  const CellPose around = to_cells(excluded.around);
  const double far_x =
      std::fabs(static_cast<double>(box.centre.x) - static_cast<double>(around.x)) + static_cast<double>(w);
  const double far_y =
      std::fabs(static_cast<double>(box.centre.y) - static_cast<double>(around.y)) + static_cast<double>(w);
  const double limit = excluded.within_m / map_.field().resolution_m - 0.01;
  const double turned =
      std::fabs(wrap_angle(static_cast<double>(box.centre.theta) - static_cast<double>(around.theta)));
  const bool near = far_x * far_x + far_y * far_y < limit * limit && limit > 0.0;
  return near && turned + static_cast<double>(half_angle(box.level)) < excluded.within_rad - 1.0e-5;
}

// Opens the box, with its prior, unless it cannot be better than the proven bound.
void CertifiedSearch::keep(OpenBox box) {
  const std::uint32_t prior = least_prior(box);
  box.bound = box.terms > kNoCost - prior ? kNoCost : box.terms + prior;
  if (box.bound >= enough()) {
    give_up(box.bound);
    return;
  }
  box.order = made_++;
  open_.push_back(box);
}

// The least prior in the box, less the errors of float32 and of rounding down.
std::uint32_t CertifiedSearch::least_prior(const OpenBox& box) const {
  if (!options_.prior) return 0;
  const double w = static_cast<double>(half_width(box.level)) + 0.001;
  const auto nearest = [](float a, float b, double half) {
    return std::max(0.0, std::fabs(static_cast<double>(a) - static_cast<double>(b)) - half);
  };
  const double dx = nearest(box.centre.x, prior_.mean_x, w);
  const double dy = nearest(box.centre.y, prior_.mean_y, w);
  const double dt =
      nearest(box.centre.theta, prior_.mean_theta, static_cast<double>(half_angle(box.level) + kAngleSlack));
  const auto limited = [this](double cost) { return std::min(cost, static_cast<double>(prior_.limit)); };
  const double cost = limited((dx * dx + dy * dy) * static_cast<double>(prior_.weight_xy)) +
                      limited(dt * dt * static_cast<double>(prior_.weight_theta));
  return static_cast<std::uint32_t>(std::max(0.0, cost * (1.0 - 1.0e-6) - 2.0));
}

// Children of a box of the fields' levels are bounded as tiles; all have the angle of a narrow window. Smaller boxes
// get their bound when they are opened, from a minorant that bounds their halves as well.
void CertifiedSearch::expand(const OpenBox& box) {
  const std::int32_t level = box.level + 1;
  if (!has_fields(level)) {
    halve(box);
    return;
  }
  const float w = half_width(level);
  const float a = half_angle(level);
  const float first = is_narrow_theta_ ? box.centre.theta : box.centre.theta - a;
  const PoseCandidate corners[] = {{box.centre.x - w, box.centre.y - w, first, 0},
                                   {box.centre.x - w, box.centre.y - w, box.centre.theta + a, 0}};
  bound_tiles(level, std::span(corners).first(is_narrow_theta_ ? 1 : 2), 2, 2, box.terms);
}

void CertifiedSearch::halve(const OpenBox& box) {
  const std::optional<PoseMinorant::Value> minorant = minorant_in(box);
  if (!minorant) return;
  const float w = half_width(box.level + 1);
  const float a = is_narrow_theta_ ? 0.0F : half_angle(box.level + 1);
  for (unsigned part = 0; part < (is_narrow_theta_ ? 4 : 8); ++part) {
    const auto side = [part](unsigned bit, float half) { return (part & bit) != 0 ? half : -half; };
    OpenBox child{.terms = box.terms,
                  .level = box.level + 1,
                  .centre = {box.centre.x + side(1, w), box.centre.y + side(2, w), box.centre.theta + side(4, a)}};
    child.terms = std::max(child.terms, least_value(*minorant, box, child));
    if (matters(child)) keep(child);
  }
}

// A minorant of a box whose parts may still matter: the quick one if it is enough to close the box, else the one from
// patches. Empty if the box is closed.
std::optional<PoseMinorant::Value> CertifiedSearch::minorant_in(const OpenBox& box) {
  ++boxes_;
  const std::uint32_t prior = box.bound - box.terms;
  const auto bound_by = [&](const PoseMinorant::Value& minorant) {
    return std::max(box.terms, least_value(minorant, box, box)) + prior;
  };
  if (has_wide_minorant(box.level)) {
    const PoseMinorant::Value wide = find_wide_minorant(box);
    const std::uint32_t bound = bound_by(wide);
    if (bound >= enough()) {
      give_up(bound);
      return std::nullopt;
    }
    if (has_fields(box.level)) return wide;
  }
  if (has_fields(box.level)) return PoseMinorant::Value{};  // too wide for patches: its parts are bounded instead
  const PoseMinorant::Value minorant = find_patch_minorant(box);
  const std::uint32_t bound = bound_by(minorant);
  const bool smallest = box.level + 1 == field_levels_ + kParts;
  if (bound < enough() && !smallest) return minorant;
  at_resolution_ = at_resolution_ || bound < enough();
  give_up(bound);
  return std::nullopt;
}

// True for boxes of two cells to half a cell, for which the fields of minorants are made, if the map has them.
bool CertifiedSearch::has_wide_minorant(std::int32_t level) const {
  return map_.bounds().has_minorants() && level < field_levels_ + kWideLevels;
}

PoseMinorant::Value CertifiedSearch::find_wide_minorant(const OpenBox& box) const {
  const MinorantLevels& fields = map_.bounds().minorants();
  const std::int32_t wide_level = box.level - field_levels_ + kWideAbove;
  const std::vector<BoundPoint>& points = wide_points_[static_cast<std::size_t>(wide_level)];
  constexpr auto kMargin = static_cast<std::int32_t>(FieldMinorant::kMargin);
  const PoseMinorantWide::Params params{.width = fields.width,
                                        .height = fields.height,
                                        .anchor_x = cost_params_.anchor_x + kMargin,
                                        .anchor_y = cost_params_.anchor_y + kMargin,
                                        .point_count = static_cast<std::uint32_t>(points.size()),
                                        .constant_unit = fields.constant_unit,
                                        .half_angle = half_angle(box.level) + kAngleSlack,
                                        .slack = slack_};
  const PoseCandidate centre{box.centre.x, box.centre.y, box.centre.theta, 0};
  PoseMinorant::Value value;
  pose_minorant_wide_host(map_.isa(), params, fields.words.data(), points.data(), &centre, 1, &value);
  return value;
}

PoseMinorant::Value CertifiedSearch::find_patch_minorant(const OpenBox& box) const {
  const FieldView& field = map_.field();
  const PoseMinorant::Params params{.width = field.width,
                                    .height = field.height,
                                    .stride = field.stride,
                                    .anchor_x = cost_params_.anchor_x,
                                    .anchor_y = cost_params_.anchor_y,
                                    .point_count = cost_params_.point_count,
                                    .cap = field.cap,
                                    .half_width = half_width(box.level),
                                    .half_angle = half_angle(box.level) + kAngleSlack,
                                    .slack = slack_};
  const PoseCandidate centre{box.centre.x, box.centre.y, box.centre.theta, 0};
  PoseMinorant::Value value;
  pose_minorant_host(map_.isa(), params, field.cells, points_.data(), &centre, 1, &value);
  return value;
}

// The least value of a box's minorant in a part of the box.
std::uint32_t CertifiedSearch::least_value(const PoseMinorant::Value& minorant, const OpenBox& box,
                                           const OpenBox& part) const {
  const auto apart = [](float a, float b) { return static_cast<double>(a) - static_cast<double>(b); };
  const double w = static_cast<double>(half_width(part.level));
  const double a = static_cast<double>(half_angle(part.level) + kAngleSlack);
  const double whole_a = static_cast<double>(half_angle(box.level) + kAngleSlack);
  const auto along = [](double slope, double offset, double half) { return slope * offset - std::fabs(slope) * half; };
  const double turn = static_cast<double>(minorant.slope_theta) * PoseMinorant::kThetaStep;
  const double rounded = static_cast<double>(points_.size()) * PoseMinorant::kThetaStep * whole_a;
  const double value = static_cast<double>(minorant.constant) +
                       along(minorant.slope_x, apart(part.centre.x, box.centre.x), w) +
                       along(minorant.slope_y, apart(part.centre.y, box.centre.y), w) +
                       along(turn, apart(part.centre.theta, box.centre.theta), a) - rounded - 1.0;
  return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(kNoCost)));
}

}  // namespace gdtslam
