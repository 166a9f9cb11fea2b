// Eye-dome lighting darkens what lies behind an edge of depth, and nothing else.
#include <gtest/gtest.h>

#include "graphics_scene.hpp"

namespace gdtslam::test {
namespace {

/// Whether the pixel is darkened against the picture without the lighting; the lighting may never brighten.
bool is_darker(const RgbaImage& lit, const RgbaImage& plain, std::uint32_t x, std::uint32_t y) {
  return lit.at(x, y)[0] + lit.at(x, y)[1] + lit.at(x, y)[2] + 3 <
         plain.at(x, y)[0] + plain.at(x, y)[1] + plain.at(x, y)[2];
}

struct Pictures {
  RgbaImage plain;
  RgbaImage lit;
};

Pictures both(OffscreenView& view, const Camera& camera, const PictureSize& size) {
  Pictures pictures;
  view.set_eye_dome(false);
  pictures.plain = view.render(camera, size);
  view.set_eye_dome(true);
  pictures.lit = view.render(camera, size);
  return pictures;
}

constexpr PictureSize kDomeSize{240, 240};
/// The widest ring: four pixels of a picture of up to 720 rows.
constexpr int kReach = 4;

class EyeDome : public ::testing::TestWithParam<std::tuple<bool, std::uint32_t, bool>> {
 protected:
  EyeDome() : view_(graphics_) {
    view_.set_samples(std::get<1>(GetParam()));
    view_.set_background(ink::kNight, std::get<2>(GetParam()));
  }
  [[nodiscard]] Camera camera() const { return camera_along_y(std::get<0>(GetParam())); }
  GraphicsContext graphics_;
  OffscreenView view_;
};

// A square 10 m away before one 14 m away: a ring on the far one around the outline of the near one darkens.
TEST_P(EyeDome, DarkensBehindAnEdgeOnly) {
  add_shape(view_, upright_square({0.0, 10.0, 0.0}, 1.0), kRed);
  add_shape(view_, upright_square({0.0, 14.0, 0.0}, 2.5), kGrey);
  const Pictures pictures = both(view_, camera(), kDomeSize);
  const Point2 edge = *project(camera(), kDomeSize, {1.0, 10.0, 0.0});
  const Point2 rim = *project(camera(), kDomeSize, {2.5, 14.0, 0.0});
  const auto inner = static_cast<int>(std::floor(edge.x()));
  const auto outer = static_cast<int>(std::floor(rim.x()));
  for (int x = 120; x < 240; ++x) {
    const auto column = static_cast<std::uint32_t>(x);
    const bool is_behind_edge = x > inner && x <= inner + kReach - 1;
    const bool is_uncertain = std::abs(x - inner) <= 1 || x == inner + kReach || std::abs(x - outer) <= 1;
    if (is_uncertain) continue;
    EXPECT_EQ(is_darker(pictures.lit, pictures.plain, column, 120), is_behind_edge) << x << ", edge at " << inner;
    EXPECT_EQ(pictures.lit.at(column, 120)[3], pictures.plain.at(column, 120)[3]) << x;
  }
  const auto beside = static_cast<std::uint32_t>(inner + 2);
  const auto farther = static_cast<std::uint32_t>(inner + 3);
  EXPECT_LT(pictures.lit.at(beside, 120)[1], 0.75 * pictures.plain.at(beside, 120)[1]) << "clearly seen";
  EXPECT_LE(pictures.lit.at(beside, 120)[1], pictures.lit.at(farther, 120)[1]) << "fades away from the edge";
}

std::string case_name(const ::testing::TestParamInfo<EyeDome::ParamType>& info) {
  return std::string(std::get<0>(info.param) ? "Parallel" : "Perspective") + "Samples" +
         std::to_string(std::get<1>(info.param)) + (std::get<2>(info.param) ? "Transparent" : "");
}
INSTANTIATE_TEST_SUITE_P(Cameras, EyeDome,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(1U, 2U, 3U), ::testing::Bool()),
                         case_name);

}  // namespace
}  // namespace gdtslam::test
