#include "cloud_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/cloud/to_position.hpp"
#include "viewer/graphics/dot_painter.hpp"

namespace gdtslam {
namespace {

constexpr std::size_t kPiece = 1U << 16U;

double stamp_for_order(const CloudPoint& point) {
  return std::isnan(point.stamp_s) ? -std::numeric_limits<double>::infinity() : point.stamp_s;
}

// When the points of a piece were measured.
struct PieceTimes {
  PieceTimes(std::span<const CloudPoint> cloud, std::span<const std::uint32_t> drawn) : count(drawn.size()) {
    first_s = stamp_for_order(cloud[drawn.front()]);
    span_s = stamp_for_order(cloud[drawn.back()]) - first_s;
    if (!(span_s > 0.0) || !std::isfinite(span_s)) {
      span_s = 0.0;  // without times, or endless: shown as a whole
      return;
    }
    ticks.resize(count);
    for (std::size_t k = 0; k < count; ++k) ticks[k] = tick_of(cloud[drawn[k]].stamp_s);
  }

  [[nodiscard]] std::uint32_t tick_of(double stamp_s) const {
    constexpr auto kMost = static_cast<double>(std::numeric_limits<std::uint32_t>::max());
    return static_cast<std::uint32_t>(std::floor((stamp_s - first_s) / span_s * kMost));
  }
  [[nodiscard]] std::size_t count_until(double stamp_s) const {
    if (stamp_s < first_s) return 0;
    if (ticks.empty() || stamp_s >= first_s + span_s) return count;
    return static_cast<std::size_t>(std::upper_bound(ticks.begin(), ticks.end(), tick_of(stamp_s)) - ticks.begin());
  }

  std::size_t count = 0;
  double first_s = 0.0;
  double span_s = 0.0;
  std::vector<std::uint32_t> ticks;  // of the points' stamps within the span; empty where all are one
};

void sort_by_time(std::span<const CloudPoint> cloud, std::vector<std::uint32_t>& drawn) {
  const auto is_before = [&cloud](std::uint32_t a, std::uint32_t b) {
    return stamp_for_order(cloud[a]) < stamp_for_order(cloud[b]);
  };
  if (!std::is_sorted(drawn.begin(), drawn.end(), is_before)) std::stable_sort(drawn.begin(), drawn.end(), is_before);
}

}  // namespace

struct CloudPoints::State {
  struct Piece {
    std::vector<Dot> dots;
    PieceTimes times;
    std::size_t shown = 0;
  };
  std::vector<Piece> pieces;
  Point3 origin = Point3::Zero();
  Bounds bounds;
  std::uint64_t shown = 0;
  PointSizes sizes;
  std::optional<KeptInView> kept_in_view;

  // Of the picture that is being drawn.
  std::optional<DotPainter> painter;
  std::vector<PictureBand> bands;
  std::vector<std::vector<std::uint32_t>> of_band;  // dots, by their place in the whole; empty for one band

  void sort_into_bands();
};

void CloudPoints::State::sort_into_bands() {
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    for (std::size_t k = 0; k < pieces[p].shown; ++k) {
      const auto [begin, end] = painter->rows_of(pieces[p].dots[k]);
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

void CloudPoints::set(std::span<const CloudPoint> cloud, std::vector<std::uint32_t> drawn, const LookOf& look_of) {
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
      const Look look = look_of(k);
      const Point3 at = to_position(cloud[k]);
      s.bounds.add(at);
      const Eigen::Vector3f place = (at - s.origin).cast<float>();
      dots.push_back({.place = {place.x(), place.y(), place.z()},
                      .colour = {look.colour.red, look.colour.green, look.colour.blue},
                      .size_code = diameter_code(look.diameter_m)});
    }
    s.pieces.push_back({std::move(dots), PieceTimes(cloud, part), part.size()});
  }
  s.shown = drawn.size();
}

void CloudPoints::show_until(double stamp_s) {
  State& s = *state_;
  s.shown = 0;
  for (State::Piece& piece : s.pieces) {
    piece.shown = piece.times.count_until(stamp_s);
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
