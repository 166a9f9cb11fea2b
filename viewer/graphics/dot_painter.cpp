#include "dot_painter.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "engine/core/elementary.hpp"
#include "viewer/scene/camera_basis.hpp"

namespace gdtslam {
namespace {

constexpr float kKeptDistance_m = 0.4F;  // what is so little nearer hides nothing
constexpr double kLeastDiameter_m = 0.001;
constexpr double kCodesPerDoubling = 20.0;
constexpr double kLogOfTwo = 0.6931471805599453;
constexpr float kSqRadius = 0.26F;  // of a disc, of its square's side: a little more than what the square holds

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
  const CameraBasis basis = basis_of(camera);
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

DotPainter::Disc DotPainter::disc_of(const Dot& dot) const {
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

DotPainter::RowRange DotPainter::rows_of(const Dot& dot) const {
  const Disc disc = disc_of(dot);
  if (!(disc.size > 0.0F)) return {};
  const float half = 0.5F * disc.size;
  const float low = std::max(std::ceil(disc.y - half - 0.5F), 0.0F);
  const float high = std::min(std::floor(disc.y + half - 0.5F) + 1.0F, height_);
  return high > low ? RowRange{static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high)} : RowRange{};
}

void DotPainter::paint(const Dot& dot, const PictureBand& band, RawPicture& picture) const {
  const Disc disc = disc_of(dot);
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

}  // namespace gdtslam
