// Where a scene shows the joints of its linkage. The scene's camera is not asked: the joints A and B lie in one plane,
// which any camera shows by a projective map, the same one at every crank angle.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <vector>

#include "gdtslam/calib/crank_rocker.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/viewer/linkage_scene.hpp"
#include "support/linkage_joints.hpp"

namespace gdtslam {
namespace {

using namespace test;
using Places = std::vector<Point2>;

constexpr PictureSize kJointsSize{600, 450};
constexpr int kCranks = 5;
double crank_of(int k) { return 0.4 + kTwoPi * k / kCranks; }

/// Takes the white pixels that hang together with this one out of the mask.
Places taken_out(std::vector<bool>& mask, std::size_t at) {
  Places blob;
  std::vector<std::size_t> open{at};
  mask[at] = false;
  while (!open.empty()) {
    const std::size_t next = open.back();
    open.pop_back();
    const std::size_t x = next % kJointsSize.width;
    const std::size_t y = next / kJointsSize.width;
    blob.emplace_back(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
    const auto take = [&](bool is_inside, std::size_t other) {
      if (!is_inside || !mask[other]) return;
      mask[other] = false;
      open.push_back(other);
    };
    take(x > 0, next - 1);
    take(x + 1 < kJointsSize.width, next + 1);
    take(y > 0, next - kJointsSize.width);
    take(y + 1 < kJointsSize.height, next + kJointsSize.width);
  }
  return blob;
}

/// Middles of the white discs that pins end with; light on the laser's edges is white too, but no disc.
Places caps_of(const RgbaImage& image) {
  std::vector<bool> mask;
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    const std::uint8_t* const pixel = &image.pixels[i];
    mask.push_back(pixel[3] == 255 && std::min({pixel[0], pixel[1], pixel[2]}) >= 235);
  }
  Places caps;
  for (std::size_t at = 0; at < mask.size(); ++at) {
    if (!mask[at]) continue;
    const Places blob = taken_out(mask, at);
    Eigen::AlignedBox2d box;
    Point2 sum = Point2::Zero();
    for (const Point2& place : blob) {
      box.extend(place);
      sum += place;
    }
    const Point2 size = box.sizes() + Point2::Ones();
    const double fill = static_cast<double>(blob.size()) / size.prod();  // of a disc: pi / 4
    const bool is_disc = std::fabs(fill - 0.785) < 0.1 && std::fabs(std::log(size.x() / size.y())) < 0.25;
    if (blob.size() >= 30 && is_disc) caps.emplace_back(sum / static_cast<double>(blob.size()));
  }
  return caps;
}

/// The caps that stay where they are while the crank turns: the two pivots, which the coupler may hide at times.
Places still_ones(const std::vector<Places>& pictures) {
  Places still;
  for (const Places& caps : pictures) {
    for (const Point2& cap : caps) {
      const auto is_here = [&](const Point2& other) { return (other - cap).norm() < 2.0; };
      const auto has_it = [&](const Places& all) { return std::any_of(all.begin(), all.end(), is_here); };
      if (std::count_if(pictures.begin(), pictures.end(), has_it) < kCranks - 2 || has_it(still)) continue;
      still.push_back(cap);
    }
  }
  return still;
}

/// The caps of A and B at each crank angle: those nearest to where a similarity through the two pivots puts them.
std::vector<std::array<Point2, 2>> moving_ones(const calib::SweepModel& model, const std::vector<Places>& pictures) {
  std::vector<std::array<Point2, 2>> found;
  const Places still = still_ones(pictures);
  EXPECT_EQ(still.size(), 2U) << model.name;
  if (still.size() != 2) return found;
  // x is seen to the right, z upward: rows of the picture grow downward.
  const auto as_complex = [](const Point2& place) { return std::complex<double>(place.x(), -place.y()); };
  const Point2 ground = expected_joints(model, 0.0).value()[0];
  const Point2 seen = still[1] - still[0];
  const bool is_rocker_first = seen.x() * ground.x() - seen.y() * ground.y() > 0.0;
  const Point2 origin = is_rocker_first ? still[0] : still[1];
  const std::complex<double> turn =
      as_complex(is_rocker_first ? seen : -seen) / std::complex<double>(ground.x(), ground.y());
  for (int k = 0; k < kCranks; ++k) {
    std::array<Point2, 2> caps;
    for (const std::size_t joint : {std::size_t{1}, std::size_t{2}}) {
      const Point2 place = expected_joints(model, crank_of(k)).value()[joint];
      const std::complex<double> at = turn * std::complex<double>(place.x(), place.y());
      const Point2 guess = origin + Point2(at.real(), -at.imag());
      const Places& all = pictures[static_cast<std::size_t>(k)];
      const auto is_nearer = [&](const Point2& a, const Point2& b) { return (a - guess).norm() < (b - guess).norm(); };
      const auto nearest = std::min_element(all.begin(), all.end(), is_nearer);
      const double reach_px = 0.2 * std::abs(turn) * model.bars.ground_m;
      const bool is_there = nearest != all.end() && (*nearest - guess).norm() < reach_px;
      EXPECT_TRUE(is_there) << model.name << ", joint " << joint << " at crank " << crank_of(k);
      if (!is_there) return {};
      caps[joint - 1] = *nearest;
    }
    found.push_back(caps);
  }
  return found;
}

/// How far the caps are, at most, from the best projective picture of the expected joints, pixels: eight unknowns,
/// which the product with the common divisor makes linear, for twenty numbers.
double misfit_px(const calib::SweepModel& model, const std::vector<std::array<Point2, 2>>& caps) {
  constexpr int kRows = 4 * kCranks;
  Eigen::Matrix<double, kRows, 8> factors;
  Eigen::Matrix<double, kRows, 1> pixels;
  for (int k = 0; k < kCranks; ++k) {
    const auto joints = expected_joints(model, crank_of(k)).value();
    for (int end = 0; end < 2; ++end) {
      const Point2 place = joints[static_cast<std::size_t>(end) + 1] / model.bars.ground_m;
      const Point2& pixel = caps[static_cast<std::size_t>(k)][static_cast<std::size_t>(end)];
      const int row = 4 * k + 2 * end;
      factors.row(row) << place.x(), place.y(), 1.0, 0.0, 0.0, 0.0, -pixel.x() * place.x(), -pixel.x() * place.y();
      factors.row(row + 1) << 0.0, 0.0, 0.0, place.x(), place.y(), 1.0, -pixel.y() * place.x(), -pixel.y() * place.y();
      pixels.segment<2>(row) = pixel;
    }
  }
  const Eigen::Matrix<double, 8, 1> map = factors.colPivHouseholderQr().solve(pixels);
  return (factors * map - pixels).cwiseAbs().maxCoeff();
}

TEST(LinkageScene, shows_joints_where_the_law_of_cosines_puts_them) {
  const GraphicsContext graphics;
  for (const char* preset : {"paper-a", "paper-b", "paper-c-calibrated"}) {
    const calib::SweepModel model = calib::sweep_model_of_preset(preset);
    LinkageScene scene(graphics, model, {.is_transparent = true, .with_panel = false});
    std::vector<Places> pictures;
    for (int k = 0; k < kCranks; ++k) pictures.push_back(caps_of(scene.render(crank_of(k), kJointsSize)));
    const auto caps = moving_ones(model, pictures);
    ASSERT_EQ(caps.size(), std::size_t{kCranks}) << preset;
    EXPECT_LT(misfit_px(model, caps), 0.5) << preset;
    using Bar = double calib::FourBar::*;
    for (const Bar bar :
         {&calib::FourBar::crank_m, &calib::FourBar::coupler_m, &calib::FourBar::rocker_m, &calib::FourBar::ground_m}) {
      calib::SweepModel other = model;
      other.bars.*bar *= 1.05;
      EXPECT_GT(misfit_px(other, caps), 2.0) << preset << " with another bar";
    }
  }
}

}  // namespace
}  // namespace gdtslam
