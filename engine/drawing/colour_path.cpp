#include "colour_path.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/elementary.hpp"
#include "lab.hpp"

namespace gdtslam {
namespace {

constexpr int kStepsPerLeg = 64;

Hue operator*(double factor, const Hue& hue) { return {factor * hue.green_red, factor * hue.blue_yellow}; }
Hue operator+(const Hue& one, const Hue& other) {
  return {one.green_red + other.green_red, one.blue_yellow + other.blue_yellow};
}

double distance(const Hue& one, const Hue& other) {
  const double across = one.green_red - other.green_red;
  const double along = one.blue_yellow - other.blue_yellow;
  return std::sqrt(across * across + along * along);
}

/// Between the second and the third of four places, a curve without a kink (Catmull and Rom's).
Hue curve(const Hue* four, double share) {
  const double squared = share * share;
  const double cubed = squared * share;
  return 0.5 * (-cubed + 2.0 * squared - share) * four[0] + 0.5 * (3.0 * cubed - 5.0 * squared + 2.0) * four[1] +
         0.5 * (-3.0 * cubed + 4.0 * squared + share) * four[2] + 0.5 * (cubed - squared) * four[3];
}

/// Where a curve leads through places, in small steps.
std::vector<Hue> way_through(const std::vector<Hue>& places) {
  std::vector<Hue> ends{2.0 * places.front() + -1.0 * places[1]};
  ends.insert(ends.end(), places.begin(), places.end());
  ends.push_back(2.0 * places.back() + -1.0 * places[places.size() - 2]);
  std::vector<Hue> way;
  for (std::size_t leg = 0; leg + 1 < places.size(); ++leg) {
    for (int step = 0; step < kStepsPerLeg; ++step) {
      way.push_back(curve(&ends[leg], static_cast<double>(step) / kStepsPerLeg));
    }
  }
  way.push_back(places.back());
  return way;
}

/// `count` places along the way, the same distance between each two.
std::vector<Hue> even_places(const std::vector<Hue>& way, std::size_t count) {
  std::vector<double> walked{0.0};
  for (std::size_t i = 1; i < way.size(); ++i) walked.push_back(walked.back() + distance(way[i - 1], way[i]));
  std::vector<Hue> places;
  std::size_t at = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double goal = walked.back() * static_cast<double>(i) / static_cast<double>(count - 1);
    while (at + 1 < way.size() && walked[at] < goal) ++at;
    const double step = walked[at] - walked[at - 1];
    const double share = step > 0.0 ? std::clamp((goal - walked[at - 1]) / step, 0.0, 1.0) : 0.0;
    places.push_back((1.0 - share) * way[at - 1] + share * way[at]);
  }
  return places;
}

}  // namespace

std::vector<Colour> even_path(double from_lightness, double to_lightness, const std::vector<Hue>& places,
                              std::size_t count) {
  const std::vector<Hue> hues = even_places(way_through(places), count);
  std::vector<Colour> table;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    table.push_back(colour_for(
        Lab{from_lightness + share * (to_lightness - from_lightness), hues[i].green_red, hues[i].blue_yellow}));
  }
  return table;
}

std::vector<Colour> even_circle(double middle_lightness, double lightness_swing, double radius, std::size_t count) {
  constexpr int kFine = 4096;
  constexpr double kTurn_rad = 6.283185307179586;
  const auto place = [&](int step) {
    const auto [sine, cosine] = sin_cos(kTurn_rad * step / kFine);
    return Lab{middle_lightness + lightness_swing * sine, radius * cosine, radius * sine};
  };
  std::vector<double> walked{0.0};
  for (int step = 1; step <= kFine; ++step) {
    const Lab before = place(step - 1);
    const Lab now = place(step);
    const double up = now.lightness - before.lightness;
    const double flat = distance({before.green_red, before.blue_yellow}, {now.green_red, now.blue_yellow});
    walked.push_back(walked.back() + std::sqrt(up * up + flat * flat));
  }
  std::vector<Colour> table;
  int at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (walked[static_cast<std::size_t>(at)] < walked.back() * static_cast<double>(i) / static_cast<double>(count))
      ++at;
    table.push_back(colour_for(place(at)));
  }
  return table;
}

}  // namespace gdtslam
