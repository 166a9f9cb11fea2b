#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "engine/drawing/plots/bars.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/drawing/theme.hpp"
#include "map_view.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "track_output.hpp"

namespace gdtslam {
namespace {

using page_sizes::kInset;
using page_sizes::kLegend;
using page_sizes::kMargin;
using page_sizes::kWidth;

/// How a scan of a drive is drawn. What matters most comes last, on top.
enum class PathMark : std::uint8_t { kTracked, kPredicted, kUnsettled, kOff };
constexpr std::array kPathMarks{PathMark::kTracked, PathMark::kPredicted, PathMark::kUnsettled, PathMark::kOff};

Colour colour_of_path(PathMark mark) {
  static constexpr std::array<Colour, kPathMarks.size()> kColours{ink::kCoupler, ink::kCurve, ink::kLaser,
                                                                  ink::kWarning};
  return kColours.at(static_cast<std::size_t>(mark));
}

PathMark path_mark_of(const TrackedScan& scan) {
  if (scan.reference && scan.reference->is_mapped && !scan.reference->is_within) return PathMark::kOff;
  if (scan.pose.is_ambiguous || scan.pose.whereabouts == Whereabouts::kFound) return PathMark::kUnsettled;
  return scan.pose.whereabouts == Whereabouts::kTracked ? PathMark::kTracked : PathMark::kPredicted;
}

bool is_known(const TrackedScan& scan) { return scan.pose.whereabouts != Whereabouts::kUnknown; }

// One line for each stretch of a kind; it begins where the one before ended, unless the robot leapt from there.
void draw_path(Canvas& canvas, const MapView& view, const TrackedDrive& drive, PathMark wanted) {
  constexpr double kLeap_m = 1.0;
  const Pen pen{.colour = colour_of_path(wanted), .width = 2.0, .opacity = 0.9};
  std::vector<Point2> line;
  const auto close = [&] {
    if (line.size() == 1) canvas.circle(line.front(), 1.0, Fill{pen.colour});
    if (line.size() > 1) canvas.polyline(line, pen);
    line.clear();
  };
  const TrackedScan* before = nullptr;
  for (const TrackedScan& scan : drive.scans) {
    const bool is_wanted = is_known(scan) && path_mark_of(scan) == wanted;
    const Point2 at_m = scan.pose.T_map_base.translation();
    const bool is_near = before != nullptr && (before->pose.T_map_base.translation() - at_m).norm() < kLeap_m;
    if (!is_wanted || !is_near) close();
    if (is_wanted && line.empty() && is_near) line.push_back(view.at(before->pose.T_map_base.translation()));
    if (is_wanted) line.push_back(view.at(at_m));
    before = is_known(scan) ? &scan : nullptr;
  }
  close();
}

void draw_path_legend(Canvas& canvas, const Point2& at, const TrackedDrive& drive, bool is_compared) {
  static constexpr std::array<const char*, kPathMarks.size()> kWords{
      "tracked", "by the wheels and poor matches", "found, or ambiguous as yet", "not where the reference has it"};
  std::array<std::uint64_t, kPathMarks.size()> counts{};
  for (const TrackedScan& scan : drive.scans) {
    if (is_known(scan)) ++counts.at(static_cast<std::size_t>(path_mark_of(scan)));
  }
  Point2 place = at;
  for (const PathMark mark : kPathMarks) {
    const auto k = static_cast<std::size_t>(mark);
    if (mark == PathMark::kOff && !is_compared) continue;
    const std::string words = fmt::format("{}: {}", kWords.at(k), counts.at(k));
    canvas.line(place + Point2(0.0, -4.5), place + Point2(20.0, -4.5), {.colour = colour_of_path(mark), .width = 3.0});
    canvas.text(place + Point2(28.0, 0.0), words, {.size = 13.0});
    place.x() += 28.0 + text_width(words, 13.0) + 26.0;
  }
}

std::string path_caption(const LocalizeJob& job, const LocalizeLimits& limits, const TrackedDrive& drive) {
  const DriveFigures figures = figures_of(drive);
  const std::uint64_t unknown = figures.whereabouts[static_cast<std::size_t>(Whereabouts::kUnknown)];
  std::string text = fmt::format("{} with odometry, from a start that was found; {} of them nowhere",
                                 plural(drive.scans.size(), "scan"), unknown);
  if (!job.reference || figures.within.of == 0) return text;
  return text + fmt::format("; within {:g} cm and {:g}° of the reference where the map has the place: {:.1f} %",
                            100.0 * limits.within_m, deg_from_rad(limits.within_rad), 100.0 * figures.within.value());
}

MapView view_of_drive(const Localizer& localizer, const TrackedDrive& drive) {
  std::vector<Point2> places;
  places.reserve(drive.scans.size());
  for (const TrackedScan& scan : drive.scans) {
    if (is_known(scan)) places.push_back(scan.pose.T_map_base.translation());
  }
  return view_of_map(localizer.field().file.view(), places);
}

}  // namespace

Canvas track_picture(const LocalizeJob& job, const Localizer& localizer, const TrackedDrive& drive) {
  const MapView view = view_of_drive(localizer, drive);
  const std::string title = "The drive of " + std::filesystem::path(job.log).filename().string() + " in the map";
  Canvas canvas(kWidth, view.card.corner.y() + view.card.height + kLegend + kMargin, title);
  canvas.rectangle({0.0, 0.0}, canvas.width(), canvas.height(), Fill{kLightTheme.page});
  canvas.text({kMargin, kMargin + 18.0}, title, {.size = 20.0, .is_bold = true});
  canvas.text({kMargin, kMargin + 41.0}, path_caption(job, localizer.limits(), drive),
              {.size = 13.0, .colour = ink::kQuiet});
  const DrawingArea& card = view.card;
  canvas.rectangle(card.corner, card.width, card.height, Fill{ink::kCard}, Pen{.colour = ink::kEdge}, 6.0);
  canvas.begin_clip(card.corner, card.width, card.height);
  draw_walls(canvas, view, localizer.field().file.view());
  for (const PathMark mark : kPathMarks) draw_path(canvas, view, drive, mark);
  canvas.end_clip();
  draw_scale_bar(canvas, {.pixels_per_m = view.pixels_per_m}, card.corner + Point2(kInset, card.height - kInset));
  draw_path_legend(canvas, card.corner + Point2(0.0, card.height + 28.0), drive, job.reference.has_value());
  return canvas;
}

}  // namespace gdtslam
