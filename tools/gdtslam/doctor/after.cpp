// gdtslam doctor --after: doubtful parts of a map, where they are, and how to correct them.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "doctor.hpp"
#include "engine/drawing/maps/map_pictures.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_pictures.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/folder/run_review.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/drawing/ticks.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostNotes = 20;  // shown on the terminal

// Drops the minus sign if all digits shown are zero.
std::string rounded(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos) text.erase(0, 1);
  return text;
}

/// A run with the remarks on it.
struct Review {
  RunDoubts doubts;
  std::vector<ReviewNote> notes;
};

std::uint64_t uncertain_scans(const LoopFindings& found) {
  std::uint64_t scans = 0;
  for (const UncertainStretch& stretch : found.uncertain) scans += stretch.to - stretch.from + 1;
  return scans;
}

std::size_t loops_on(const LoopFindings& found) {
  std::size_t on = 0;
  for (const ClosedLoop& loop : found.loops) on += loop.is_on ? 1U : 0U;
  return on;
}

std::string loops_text(const Review& review) {
  if (!review.doubts.loops) return "loops            not closed\n";
  const LoopFindings& found = *review.doubts.loops;
  std::string text = fmt::format("loops            {} found in {} searches, {} of them hold\n", found.loops.size(),
                                 found.searches, loops_on(found));
  text += fmt::format("uncertainty      standard deviation {:.2g} m in the middle, up to {:.2g} m\n",
                      found.sigma_median_m, found.sigma_max_m);
  text += fmt::format("not trusted      {}, {}, in {}: above {:g} m\n", plural(uncertain_scans(found), "scan"),
                      percent_text(uncertain_scans(found), review.doubts.scans),
                      found.uncertain.size() == 1 ? "1 stretch" : fmt::format("{} stretches", found.uncertain.size()),
                      found.above_m);
  const WheelReport& wheels = found.wheels;
  text += fmt::format("wheels           miss {} % of distances, {} % of turns, {} deg in each metre\n",
                      rounded(100.0 * wheels.distance, 1), rounded(100.0 * wheels.turn, 1),
                      rounded(deg_from_rad(wheels.turn_rad_per_m), 2));
  return text + fmt::format("                 (standard deviations {:.1f} %, {:.1f} %, {:.2f} deg)\n",
                            100.0 * wheels.sigma_distance, 100.0 * wheels.sigma_turn,
                            deg_from_rad(wheels.sigma_rad_per_m));
}

std::string review_text(const RunReader& run, const Review& review) {
  const RunDoubts& doubts = review.doubts;
  std::string text = fmt::format("run              {}: {}, {}, {:.1f} m of path\n", printable(run.folder()), run.name(),
                                 counted(doubts.scans, "scan"), run.summary().path_m);
  text += fmt::format("scans            {} accepted, {} with weak evidence, {} refused ({})\n", doubts.accepted,
                      doubts.weak, doubts.refused, percent_text(doubts.refused, doubts.scans));
  text += loops_text(review);
  if (review.notes.empty()) return text + "Nothing in this map is doubtful.\n";
  text += "Doubtful:\n";
  for (std::size_t k = 0; k < review.notes.size() && k < kMostNotes; ++k) {
    text += fmt::format("{:>3}. {}\n  -> {}\n", k + 1, review.notes[k].finding, review.notes[k].advice);
  }
  if (review.notes.size() > kMostNotes) {
    text += fmt::format("     and {} more; --json has all\n", review.notes.size() - kMostNotes);
  }
  return text;
}

Json notes_json(const Review& review) {
  Json list = Json::array();
  for (const ReviewNote& note : review.notes) {
    list.push_back({{"number", list.size() + 1},
                    {"about", note.about},
                    {"finding", note.finding},
                    {"advice", note.advice},
                    {"at_m", note.at_m ? Json({note.at_m->x(), note.at_m->y()}) : Json()}});
  }
  return list;
}

Json review_json(const RunReader& run, const Review& review) {
  const RunDoubts& doubts = review.doubts;
  Json json{{"run", run.folder()},
            {"scans", doubts.scans},
            {"interrupted", doubts.was_interrupted},
            {"matches", {{"accepted", doubts.accepted}, {"weak", doubts.weak}, {"refused", doubts.refused}}},
            {"loops", nullptr},
            {"uncertain", nullptr},
            {"wheels", nullptr},
            {"notes", notes_json(review)}};
  if (!doubts.loops) return json;
  const LoopFindings& found = *doubts.loops;
  json["loops"] = {{"found", found.loops.size()}, {"on", loops_on(found)}, {"searches", found.searches}};
  json["uncertain"] = {{"above_m", found.above_m},
                       {"sigma_median_m", found.sigma_median_m},
                       {"sigma_max_m", found.sigma_max_m},
                       {"scans", uncertain_scans(found)}};
  json["wheels"] = wheels_json(found.wheels);
  return json;
}

// Draws the graph; places are numbered as in the list.
void draw_review(const RunReader& run, const Review& review, const Trajectory& trajectory,
                 const std::vector<PoseCovariance>& covariances, const std::string& file) {
  const LoopFindings found = review.doubts.loops.value_or(LoopFindings{});
  const OccupancyMap map = run.map();
  GraphOverlay overlay = graph_overlay(trajectory, run.summary().keyframes, found.loops, covariances, found.uncertain,
                                       run.summary().drives);
  for (std::size_t k = 0; k < review.notes.size(); ++k) {
    if (review.notes[k].at_m) overlay.numbers.push_back({*review.notes[k].at_m, k + 1});
  }
  MapLook look;
  look.title = run.name();
  look.subtitle = review.doubts.loops ? graph_subtitle(found.loops, found.uncertain, review.doubts.scans)
                                      : counted(review.doubts.scans, "scan") + ", loops not closed";
  const PictureSize size = size_for_content(map.geometry.width, map.geometry.height);
  write_file_atomically(file, drawing_bytes(graph_picture(map, overlay, look, size), file));
}

}  // namespace

int doctor_after(const DoctorOptions& options) {
  if (!options.picture.empty()) {
    check_drawing_file("--picture", options.picture);
    WrittenFiles({options.after}, options.force).add("--picture", options.picture);
  }
  const RunReader run(options.after);
  const Trajectory trajectory = run.trajectory();
  const std::vector<PoseCovariance> covariances = run.covariances().value_or(std::vector<PoseCovariance>());
  const RunDoubts doubts = run.doubts();
  const Review review{doubts, review_notes(doubts, trajectory, covariances)};
  if (!options.picture.empty()) draw_review(run, review, trajectory, covariances, options.picture);
  print_result(options.json ? json_text(review_json(run, review)) : review_text(run, review));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace gdtslam
