// The picture of a log: every word on the page, none over another one, and no more panels than there are figures.
#include "engine/drawing/plots/log_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/picture_scene.hpp"

namespace gdtslam {
namespace {

using test::shapes_of;

constexpr double kNoSpeed = std::numeric_limits<double>::quiet_NaN();

LogPicture a_log(double length_s, double size) {
  LogPicture log;
  log.title = "drive.bag";
  log.subtitle = "1,000 scans";
  log.length = length_s;
  for (int k = 0; k < 200; ++k) {
    const double at_s = length_s * (k + 0.5) / 200.0;
    const double wave = std::sin(0.1 * k);
    log.rates_hz.emplace_back(at_s, k == 50 ? 0.0 : 10.0 * size);
    log.speeds_m_s.emplace_back(at_s, k == 60 ? kNoSpeed : size * wave * wave);
    log.turns_deg_s.emplace_back(at_s, 30.0 * size * wave);
    log.ranges.push_back({at_s, 0.1 * size, size, 2.0 * size, 3.0 * size, (4.0 + wave) * size});
    log.missing_percent.emplace_back(at_s, 50.0 + 50.0 * wave);
    log.elevations_deg.emplace_back(Point2(at_s, -10.0 * size), Point2(at_s, 20.0 * size * wave));
  }
  log.gaps_s = {{0.25 * length_s, 0.3 * length_s}, {0.5 * length_s, 0.51 * length_s}};
  log.jumps_s = {0.7 * length_s};
  return log;
}

struct Extent {
  double left, top, right, bottom;
};
Extent extent_of_words(const shape::Words& words) {
  const double width = text_width(words.text, words.lettering.size, words.lettering.is_bold);
  const double height = 0.76 * words.lettering.size;
  const double start = words.lettering.anchor == Anchor::kStart ? 0.0
                       : words.lettering.anchor == Anchor::kEnd ? 1.0
                                                                : 0.5;
  const double x = words.at.x();
  const double y = words.at.y();
  if (words.is_upright) return {x - height, y - (1.0 - start) * width, x, y + start * width};
  return {x - start * width, y - height, x + (1.0 - start) * width, y};
}

TEST(LogPicture, IsTidyWhateverTheSizes) {
  for (const double length_s : {0.5, 65.0, 2691.3, 40000.0}) {
    for (const double size : {0.003, 1.0, 12345.0}) {
      const LogPicture log = a_log(length_s, size);
      const PictureSize page = size_of_log_picture(log);
      std::vector<shape::Words> words = shapes_of<shape::Words>(log_picture(log, page));
      std::erase_if(words, [](const shape::Words& one) { return one.text.empty(); });  // of ticks without labels
      for (std::size_t i = 0; i < words.size(); ++i) {
        const Extent one = extent_of_words(words[i]);
        EXPECT_TRUE(one.left >= 0.0 && one.top >= 0.0 && one.right <= page.width && one.bottom <= page.height)
            << words[i].text << " of " << length_s << " s, " << size;
        for (std::size_t k = 0; k < i; ++k) {
          const Extent other = extent_of_words(words[k]);
          EXPECT_FALSE(one.left < other.right && other.left < one.right && one.top < other.bottom &&
                       other.top < one.bottom)
              << words[i].text << " over " << words[k].text << " of " << length_s << " s, " << size;
        }
      }
    }
  }
}

std::vector<std::string> titles_of(const LogPicture& log) {
  std::vector<std::string> titles;
  for (const shape::Words& words : shapes_of<shape::Words>(log_picture(log, size_of_log_picture(log)))) {
    if (words.is_upright) titles.push_back(words.text);
  }
  return titles;
}

TEST(LogPicture, HasThePanelsThatThereAreFiguresFor) {
  LogPicture log = a_log(100.0, 1.0);
  EXPECT_THAT(titles_of(log), testing::ElementsAre("Scans (1/s)", "Speed (m/s)", "Turning (°/s)", "Elevation (°)",
                                                   "Ranges (m)", "No return (%)"));
  log.speeds_m_s.clear();
  log.turns_deg_s.clear();
  log.elevations_deg.clear();
  EXPECT_THAT(titles_of(log), testing::ElementsAre("Scans (1/s)", "Ranges (m)", "No return (%)"));
  log.rates_hz.clear();
  log.is_by_time = false;
  EXPECT_THAT(titles_of(log), testing::ElementsAre("Ranges (m)", "No return (%)"));
}

TEST(LogPicture, NothingAtAllIsDrawn) {
  const LogPicture empty;
  EXPECT_THAT(titles_of(empty), testing::SizeIs(2));
}

}  // namespace
}  // namespace gdtslam
