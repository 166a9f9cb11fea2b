// The picture of a registration shows where the clouds lie: apart at the start, on each other at the result.
#include "tools/gdtslam/register/alignment_picture.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <variant>
#include <vector>

#include "engine/core/to_position.hpp"
#include "gdtslam/core/random.hpp"

namespace gdtslam {
namespace {

// Points of a floor and of two walls at a corner.
Cloud make_corner() {
  Cloud cloud;
  Random random(7);
  for (int k = 0; k < 6000; ++k) {
    const double along = random.uniform(0.0, 4.0);
    const double aside = random.uniform(0.0, 2.0);
    const std::array places{Point3(along, aside, 0.0), Point3(along, 0.0, aside), Point3(0.0, 0.5 * along, aside)};
    cloud.push_back(to_cloud_point(places.at(static_cast<std::size_t>(k) % places.size())));
  }
  return cloud;
}

struct Shares {
  double fixed = 0.0;
  double moved = 0.0;
  double both = 0.0;
};

// Shares of the drawn cells in the three colours: blue, orange and a dark grey.
Shares count_inks(const RgbaImage& image) {
  Shares shares;
  double all = 0.0;
  for (std::size_t k = 0; k < image.pixels.size(); k += 4) {
    if (image.pixels[k + 3] == 0) continue;
    const int blue_less_red = int{image.pixels[k + 2]} - int{image.pixels[k]};
    ++(blue_less_red > 100 ? shares.fixed : blue_less_red < -100 ? shares.moved : shares.both);
    ++all;
  }
  return {shares.fixed / all, shares.moved / all, shares.both / all};
}

std::vector<RgbaImage> images_of(const Canvas& canvas) {
  std::vector<RgbaImage> images;
  for (const Shape& drawn : canvas.shapes()) {
    if (const auto* const picture = std::get_if<shape::Picture>(&drawn)) images.push_back(*picture->image);
  }
  return images;
}

TEST(AlignmentPictureTest, CloudsAreApartAtTheStartAndOnEachOtherAtTheResult) {
  const Cloud a = make_corner();
  Alignment found;
  found.T_a_b = {{1.0, -0.4, 0.3}, exp_so3({0.02, 0.0, 0.6})};
  Cloud b;
  for (const CloudPoint& point : a) b.push_back(to_cloud_point(inverse(found.T_a_b) * to_position(point)));
  const std::vector<RgbaImage> images = images_of(draw_alignment("a pair", a, b, {}, found));
  ASSERT_EQ(images.size(), 4U);  // from above and from the side, before and after
  EXPECT_EQ(images[0].height, images[2].height);
  EXPECT_EQ(images[1].height, images[3].height);
  for (const std::size_t before : {0U, 1U}) {
    const Shares shares = count_inks(images[before]);
    EXPECT_GT(shares.fixed, 0.3);
    EXPECT_GT(shares.moved, 0.3);
  }
  for (const std::size_t after : {2U, 3U}) EXPECT_GT(count_inks(images[after]).both, 0.95);
}

// A start beyond sight must not shrink the result, and no point may be written outside of an image.
TEST(AlignmentPictureTest, FarStartLeavesTheResultLarge) {
  const Cloud a = make_corner();
  const std::vector<RgbaImage> images = images_of(draw_alignment("a pair", a, a, {{1.0e6, -1.0e6, 1.0e6}, {}}, {}));
  ASSERT_EQ(images.size(), 4U);
  EXPECT_EQ(count_inks(images[0]).fixed, 1.0);
  std::size_t columns = 0;
  for (std::uint32_t x = 0; x < images[2].width; ++x) {
    bool is_drawn = false;
    for (std::uint32_t y = 0; y < images[2].height; ++y) is_drawn = is_drawn || images[2].at(x, y)[3] > 0;
    columns += is_drawn ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(columns), 0.4 * images[2].width);
}

}  // namespace
}  // namespace gdtslam
