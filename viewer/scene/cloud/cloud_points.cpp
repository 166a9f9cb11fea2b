#include "cloud_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <utility>

#include "engine/core/elementary.hpp"
#include "engine/core/to_position.hpp"
#include "gdtslam/viewer/camera.hpp"

namespace gdtslam {
namespace {

constexpr float kKeptDistance_m = 0.4F;  // a point hides nothing if it is nearer by less than this
constexpr double kLeastDiameter_m = 0.001;
constexpr double kCodesPerDoubling = 20.0;
constexpr double kLogOfTwo = 0.6931471805599453;
constexpr float kSqRadius = 0.26F;  // in sides of the disc's square: slightly larger than the inscribed disc

constexpr std::size_t kPiece = 1U << 16U;

double stamp_for_order(const CloudPoint& point) {
  return std::isnan(point.stamp_s) ? -std::numeric_limits<double>::infinity() : point.stamp_s;
}

/// Stamps of a piece of points sorted by time; a single one if the points have no times or infinite ones: the piece is
/// then shown as a whole.
std::vector<double> piece_stamps(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn) {
  const double first_s = stamp_for_order(cloud[drawn.front()]);
  const double last_s = stamp_for_order(cloud[drawn.back()]);
  if (!(last_s > first_s) || !std::isfinite(last_s - first_s)) return {first_s};
  std::vector<double> stamps_s(drawn.size());
  std::transform(drawn.begin(), drawn.end(), stamps_s.begin(), [&](std::uint32_t k) { return cloud[k].stamp_s; });
  return stamps_s;
}

void sort_by_time(std::span<const CloudPoint> cloud, std::vector<std::uint32_t>& drawn) {
  const auto is_before = [&cloud](std::uint32_t a, std::uint32_t b) {
    return stamp_for_order(cloud[a]) < stamp_for_order(cloud[b]);
  };
  if (!std::is_sorted(drawn.begin(), drawn.end(), is_before)) std::stable_sort(drawn.begin(), drawn.end(), is_before);
}

}  // namespace

std::uint8_t diameter_code(double diameter_m) {
  const double doublings = gdtslam::log(std::max(diameter_m, kLeastDiameter_m) / kLeastDiameter_m) / kLogOfTwo;
  return static_cast<std::uint8_t>(std::min(255.0, std::floor(doublings * kCodesPerDoubling + 0.5)));
}

DotPainter::DotPainter(const PictureView& view, const Point3& origin, const DotSizes& sizes,
                       const std::optional<KeptInView>& kept_in_view)
    : is_parallel_(view.camera.is_parallel),
      width_(static_cast<float>(view.width)),
      height_(static_cast<float>(view.height)),
      nearest_m_(static_cast<float>(view.range.nearest_m)),
      farthest_m_(static_cast<float>(view.range.farthest_m)),
      sizes_(sizes) {
  const Camera& camera = view.camera;
  const double metre_px = view.height / (is_parallel_ ? camera.parallel_height_m : 2.0 * half_height_slope(camera));
  const CameraBasis basis = camera_basis(camera);
  const Point3 from_eye = origin - camera.eye;
  right_ = (metre_px * basis.right).cast<float>();
  up_ = (metre_px * basis.up).cast<float>();
  ahead_ = basis.forward.cast<float>();
  right_at_ = static_cast<float>(metre_px * basis.right.dot(from_eye));
  up_at_ = static_cast<float>(metre_px * basis.up.dot(from_eye));
  ahead_at_ = static_cast<float>(basis.forward.dot(from_eye));
  for (std::size_t code = 0; code < size_px_.size(); ++code) {
    const double doublings = static_cast<double>(code) / kCodesPerDoubling;
    size_px_[code] = static_cast<float>(metre_px * kLeastDiameter_m * gdtslam::exp(doublings * kLogOfTwo));
  }
  if (!kept_in_view) return;
  const Point3 kept_from_eye = kept_in_view->place - camera.eye;
  const double distance_m = is_parallel_ ? 1.0 : basis.forward.dot(kept_from_eye);
  if (is_parallel_ || distance_m <= 0.0) return;
  kept_ = Kept{static_cast<float>(metre_px * basis.right.dot(kept_from_eye) / distance_m),
               static_cast<float>(metre_px * basis.up.dot(kept_from_eye) / distance_m), static_cast<float>(distance_m),
               static_cast<float>((kept_in_view->place - origin).z()),
               static_cast<float>(metre_px * kept_in_view->radius_m / distance_m)};
}

bool DotPainter::hides_what_is_kept(const Dot& dot, float x, float y, float distance_m) const {
  if (!kept_ || kept_->distance_m - distance_m <= kKeptDistance_m || dot.place[2] <= kept_->height_m) return false;
  const float off_x = x - kept_->x;
  const float off_y = y - kept_->y;
  return off_x * off_x + off_y * off_y < kept_->radius * kept_->radius;
}

DotPainter::Disc DotPainter::seen_disc(const Dot& dot) const {
  const Eigen::Vector3f place(dot.place[0], dot.place[1], dot.place[2]);
  const float distance_m = ahead_.dot(place) + ahead_at_;
  if (!(distance_m >= nearest_m_ && distance_m <= farthest_m_)) return {};
  const float scale = is_parallel_ ? 1.0F : 1.0F / distance_m;
  const float x = (right_.dot(place) + right_at_) * scale;
  const float y = (up_.dot(place) + up_at_) * scale;
  if (!(std::fabs(x) <= 0.5F * width_ && std::fabs(y) <= 0.5F * height_)) return {};
  if (hides_what_is_kept(dot, x, y, distance_m)) return {};
  const float share = (distance_m - nearest_m_) / (farthest_m_ - nearest_m_);
  return {.x = x + 0.5F * width_,
          .y = y + 0.5F * height_,
          .depth = is_parallel_ ? share : share * farthest_m_ * scale,
          .size = std::clamp(size_px_[dot.size_code] * scale, static_cast<float>(sizes_.least_px),
                             static_cast<float>(sizes_.largest_px))};
}

DotPainter::RowRange DotPainter::touched_rows(const Dot& dot) const {
  const Disc disc = seen_disc(dot);
  if (!(disc.size > 0.0F)) return {};
  const float half = 0.5F * disc.size;
  const float low = std::max(std::ceil(disc.y - half - 0.5F), 0.0F);
  const float high = std::min(std::floor(disc.y + half - 0.5F) + 1.0F, height_);
  return high > low ? RowRange{static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high)} : RowRange{};
}

void DotPainter::paint(const Dot& dot, const PictureBand& band, RawPicture& picture) const {
  const Disc disc = seen_disc(dot);
  if (!(disc.size > 0.0F)) return;
  const float half = 0.5F * disc.size;
  const float sq_radius = kSqRadius * disc.size * disc.size;
  const std::array<std::uint8_t, 4> rgba{dot.colour[0], dot.colour[1], dot.colour[2], 255};
  const float bottom = disc.y - static_cast<float>(band.first_row);
  const auto row_begin = static_cast<std::int32_t>(std::max(std::ceil(bottom - half - 0.5F), 0.0F));
  const auto row_end =
      static_cast<std::int32_t>(std::min(std::floor(bottom + half - 0.5F), static_cast<float>(band.rows) - 1.0F));
  for (std::int32_t row = row_begin; row <= row_end; ++row) {
    const float off = static_cast<float>(row) + 0.5F - bottom;
    const float reach = std::min(half, std::sqrt(std::max(sq_radius - off * off, 0.0F)));
    const auto begin = static_cast<std::int32_t>(std::max(std::ceil(disc.x - reach - 0.5F), 0.0F));
    const auto end = static_cast<std::int32_t>(std::min(std::floor(disc.x + reach - 0.5F), width_ - 1.0F));
    const std::size_t first = static_cast<std::size_t>(row) * picture.width;
    for (std::int32_t x = begin; x <= end; ++x) {
      const std::size_t at = first + static_cast<std::size_t>(x);
      if (!(disc.depth < picture.depth[at])) continue;
      picture.depth[at] = disc.depth;
      std::memcpy(picture.rgba.data() + 4 * at, rgba.data(), rgba.size());
    }
  }
}

struct CloudPoints::State {
  struct Piece {
    std::vector<Dot> dots;
    std::vector<double> stamps_s;  ///< one per dot, or one for all
    std::size_t shown = 0;
  };
  std::vector<Piece> pieces;
  Point3 origin = Point3::Zero();
  Bounds bounds;
  std::uint64_t shown = 0;
  PointSizes sizes;
  std::optional<KeptInView> kept_in_view;

  // State of the picture that is being drawn.
  std::optional<DotPainter> painter;
  std::vector<PictureBand> bands;
  std::vector<std::vector<std::uint32_t>> of_band;  // indices of dots in the whole; empty for a single band

  void sort_into_bands();
};

void CloudPoints::State::sort_into_bands() {
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    for (std::size_t k = 0; k < pieces[p].shown; ++k) {
      const auto [begin, end] = painter->touched_rows(pieces[p].dots[k]);
      for (std::size_t b = 0; b < bands.size(); ++b) {
        if (begin < bands[b].first_row + bands[b].rows && end > bands[b].first_row) {
          of_band[b].push_back(static_cast<std::uint32_t>(p * kPiece + k));
        }
      }
    }
  }
}

CloudPoints::CloudPoints() : state_(std::make_unique<State>()) {}

CloudPoints::~CloudPoints() = default;

void CloudPoints::set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const LookOf& point_look) {
  State& s = *state_;
  sort_by_time(cloud, drawn);
  s.origin = to_position(cloud[drawn.front()]);
  const std::span<const std::uint32_t> all(drawn);
  s.pieces.reserve(all.size() / kPiece + 1);
  for (std::size_t begin = 0; begin < all.size(); begin += kPiece) {
    const auto part = all.subspan(begin, std::min(kPiece, all.size() - begin));
    std::vector<Dot> dots;
    dots.reserve(part.size());
    for (const std::uint32_t k : part) {
      const Look look = point_look(k);
      const Point3 at = to_position(cloud[k]);
      s.bounds.add(at);
      const Eigen::Vector3f place = (at - s.origin).cast<float>();
      dots.push_back({.place = {place.x(), place.y(), place.z()},
                      .colour = {look.colour.red, look.colour.green, look.colour.blue},
                      .size_code = diameter_code(look.diameter_m)});
    }
    s.pieces.push_back({std::move(dots), piece_stamps(cloud, part), part.size()});
  }
  s.shown = drawn.size();
}

void CloudPoints::show_until(double stamp_s) {
  State& s = *state_;
  s.shown = 0;
  for (State::Piece& piece : s.pieces) {
    const auto end = std::upper_bound(piece.stamps_s.begin(), piece.stamps_s.end(), stamp_s);
    const auto count = static_cast<std::size_t>(end - piece.stamps_s.begin());
    piece.shown = piece.stamps_s.size() == 1 ? count * piece.dots.size() : count;
    s.shown += piece.shown;
  }
}

void CloudPoints::set_sizes(const PointSizes& sizes) { state_->sizes = sizes; }

void CloudPoints::keep_in_view(const std::optional<KeptInView>& kept) { state_->kept_in_view = kept; }

std::uint64_t CloudPoints::shown() const { return state_->shown; }

const Bounds& CloudPoints::bounds() const { return state_->bounds; }

void CloudPoints::begin(const PictureView& view) {
  State& s = *state_;
  const double samples = s.sizes.samples;
  s.painter.emplace(view, s.origin,
                    DotSizes{.least_px = samples * s.sizes.least_px, .largest_px = samples * s.sizes.largest_px},
                    s.kept_in_view);
  s.bands = view.bands;
  s.of_band.clear();
  if (s.bands.size() < 2) return;
  s.of_band.resize(s.bands.size());
  s.sort_into_bands();
}

void CloudPoints::draw(std::size_t band, RawPicture& picture) {
  State& s = *state_;
  if (s.of_band.empty()) {
    for (const State::Piece& piece : s.pieces) {
      for (std::size_t k = 0; k < piece.shown; ++k) s.painter->paint(piece.dots[k], s.bands[band], picture);
    }
    return;
  }
  for (const std::uint32_t dot : s.of_band[band]) {
    s.painter->paint(s.pieces[dot / kPiece].dots[dot % kPiece], s.bands[band], picture);
  }
  std::vector<std::uint32_t>().swap(s.of_band[band]);
}

}  // namespace gdtslam
