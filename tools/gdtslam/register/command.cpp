// gdtslam register: the pose of a cloud in another one.
#include <fmt/format.h>
#include <CLI/App.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/cloud_alignment.hpp"
#include "engine/cloud/ndt_map.hpp"
#include "engine/core/one_line.hpp"
#include "engine/core/to_position.hpp"
#include "engine/io/atomic_file.hpp"
#include "engine/io/json_file.hpp"
#include "engine/runs/folder/run_reader.hpp"
#include "engine/runs/registration/ndt_file.hpp"
#include "engine/runs/registration/wall_search.hpp"
#include "gdtslam/core/angle.hpp"
#include "gdtslam/core/error.hpp"
#include "gdtslam/io/cloud_file.hpp"
#include "tools/gdtslam/drawings/drawing_file.hpp"
#include "tools/gdtslam/register/alignment_picture.hpp"
#include "tools/gdtslam/shell/commands.hpp"
#include "tools/gdtslam/shell/console.hpp"
#include "tools/gdtslam/shell/device/device_option.hpp"
#include "tools/gdtslam/shell/help/offers.hpp"
#include "tools/gdtslam/shell/options.hpp"
#include "tools/gdtslam/shell/written_files.hpp"

namespace gdtslam {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostPoints = 200'000'000;
constexpr std::size_t kMostPlaces = 4;
constexpr double kSampleSpacing_m = 0.05;  // of a cloud of normal distributions
constexpr std::array<const char*, 6> kDirections{"x", "y", "z", "roll", "pitch", "yaw"};

struct RegisterCommand {
  std::string fixed;
  std::string moved;
  std::string method = "both";
  int dof = 6;
  std::string start;
  std::string output;
  std::string picture;
  DeviceOptions device{};
  bool force = false;
  bool json = false;
};

/// A cloud and what its file's coordinates are beyond those of the points.
struct GivenCloud {
  std::string file;
  Cloud points;
  std::array<double, 3> origin_m{};
};

GivenCloud read_given(const std::string& given) {
  GivenCloud cloud;
  std::optional<RunReader> run;
  std::uint64_t skipped = 0;
  if (is_ndt_file(given)) return {.file = given, .points = sample_cloud(read_ndt(given), kSampleSpacing_m)};
  cloud.file = given_cloud(given, run);
  const auto read = [&] { return read_cloud(cloud.file, kMostPoints, &skipped, &cloud.origin_m); };
  cloud.points = run ? run->files().unless_changed(read) : read();
  if (skipped > 0) {
    print_remark(fmt::format("warning: {} points of {} are not finite and left out", skipped, cloud.file));
  }
  return cloud;
}

// Yaw, then pitch, then roll, as the fixed axes of the first cloud see them.
Eigen::Quaterniond rotation_of(double roll_rad, double pitch_rad, double yaw_rad) {
  return exp_so3({0.0, 0.0, yaw_rad}) * exp_so3({0.0, pitch_rad, 0.0}) * exp_so3({roll_rad, 0.0, 0.0});
}

Point3 roll_pitch_yaw(const Pose3& T) {
  const Eigen::Matrix3d R = rotation_matrix(T.rotation);
  return {std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)), std::atan2(R(1, 0), R(0, 0))};
}

Pose3 parse_start(const std::string& text) {
  const std::vector<std::string> words = words_between_commas(text);
  std::array<double, 6> values{};
  if (words.size() != values.size()) {
    throw UsageError("--start: '" + text + "' is not X,Y,Z,ROLL,PITCH,YAW, for example 1.5m,0,0,0,0,20deg");
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] = quantity_of("--start", words[k], k < 3 ? Unit::kMetre : Unit::kRadian);
    if (!(std::fabs(values[k]) <= 1.0e6)) throw UsageError("--start: " + words[k] + " is not between -1e6 and 1e6");
  }
  return {{values[0], values[1], values[2]}, rotation_of(values[3], values[4], values[5])};
}

AlignmentOptions make_options(const RegisterCommand& command) {
  AlignmentOptions options{.is_planar = command.dof == 3};
  if (command.method == "ndt") options.method = AlignmentMethod::kNdt;
  if (command.method == "plane") options.method = AlignmentMethod::kPlane;
  options.is_first_kept = !command.start.empty();
  if (options.is_first_kept) options.starts = {{parse_start(command.start)}};
  return options;
}

// Adds the places that the walls of both clouds allow: to begin from, or as rivals of a given start.
void add_places(const Cloud& fixed, const Cloud& moved, Backend& backend, AlignmentOptions& options) {
  for (const WallPlace& place : find_by_walls(fixed, moved, kMostPlaces, backend)) {
    options.starts.push_back({embed(place.T_a_b), !options.is_planar});
  }
}

const char* weakest_direction(const Alignment& found) {
  Eigen::Index largest = 0;
  found.weakest.cwiseAbs().maxCoeff(&largest);
  return kDirections.at(static_cast<std::size_t>(largest));
}

// "1.20 m, 0.30 m, 0.00 m, yaw 178 deg"
std::string describe(const Pose3& T) {
  const Point3& at = T.translation_m;
  return fmt::format("{:.2f} m, {:.2f} m, {:.2f} m, yaw {:.0f} deg", at.x(), at.y(), at.z(),
                     deg_from_rad(roll_pitch_yaw(T).z()));
}

std::string verdict_of(const Alignment& found) {
  if (found.is_believed()) return "registered";
  if (found.after.overlap < Alignment::kLeastOverlap) {
    return fmt::format("doubtful: only {:.0f} % of its points have a neighbour", 100.0 * found.after.overlap);
  }
  if (found.after.on_planes < Alignment::kLeastOnPlanes) {
    return fmt::format("doubtful: only {:.0f} % of the points where they overlap lie on planes",
                       100.0 * found.after.on_planes);
  }
  if (found.fits_elsewhere()) {
    return fmt::format("doubtful: it fits {} at {}", found.is_first_kept ? "better" : "about as well",
                       describe(*found.T_a_b_elsewhere));
  }
  if (found.weakest_share < Alignment::kLeastShare) {
    return fmt::format("doubtful: nothing holds {}", weakest_direction(found));
  }
  return "doubtful: the steps do not come to rest";
}

std::string as_text(const RegisterCommand& command, const Alignment& found) {
  const Point3 at = found.T_a_b.translation_m;
  const Point3 turns = roll_pitch_yaw(found.T_a_b);
  const auto deg = [](double rad) { return deg_from_rad(rad); };
  std::string text =
      fmt::format("{} in {}: {}\n", printable(command.moved), printable(command.fixed), verdict_of(found));
  text += fmt::format("  position         {:9.4f} {:9.4f} {:9.4f} m     sigma {:.1f} {:.1f} {:.1f} mm\n", at.x(),
                      at.y(), at.z(), 1e3 * found.sigma[0], 1e3 * found.sigma[1], 1e3 * found.sigma[2]);
  text +=
      fmt::format("  roll, pitch, yaw {:9.3f} {:9.3f} {:9.3f} deg   sigma {:.3f} {:.3f} {:.3f} deg\n", deg(turns.x()),
                  deg(turns.y()), deg(turns.z()), deg(found.sigma[3]), deg(found.sigma[4]), deg(found.sigma[5]));
  text += fmt::format("  overlap          {:.0f} % of its points lie within 30 cm ({:.0f} % at the start)\n",
                      100.0 * found.after.overlap, 100.0 * found.before.overlap);
  text += fmt::format("  on planes        {:.0f} % of them lie within 5 cm of its planes ({:.0f} % at the start)\n",
                      100.0 * found.after.on_planes, 100.0 * found.before.on_planes);
  if (found.T_a_b_elsewhere) {
    text +=
        fmt::format("  elsewhere        {:.0f} % overlap, {:.0f} % on planes at {}\n", 100.0 * found.elsewhere.overlap,
                    100.0 * found.elsewhere.on_planes, describe(*found.T_a_b_elsewhere));
  }
  text += fmt::format("  median distance  {:.1f} mm from the planes ({:.1f} mm at the start)\n",
                      1e3 * found.after.median_m, 1e3 * found.before.median_m);
  text += fmt::format("  held least       {}, {:.2f} of the direction held best\n", weakest_direction(found),
                      found.weakest_share);
  return text;
}

Json fit_json(const CloudFit& fit) {
  return {{"overlap", fit.overlap}, {"on_planes", fit.on_planes}, {"median_m", fit.median_m}};
}

Json elsewhere_json(const Alignment& found) {
  if (!found.T_a_b_elsewhere) return {};
  const Pose3& T = *found.T_a_b_elsewhere;
  const Point3 turns = roll_pitch_yaw(T);
  Json json = fit_json(found.elsewhere);
  json["position_m"] = {T.translation_m.x(), T.translation_m.y(), T.translation_m.z()};
  json["roll_pitch_yaw_deg"] = {deg_from_rad(turns.x()), deg_from_rad(turns.y()), deg_from_rad(turns.z())};
  return json;
}

std::string as_json(const Alignment& found) {
  const Point3 turns = roll_pitch_yaw(found.T_a_b);
  const Eigen::Quaterniond& q = found.T_a_b.rotation;
  Json json;
  json["verdict"] = found.is_believed() ? "registered" : "doubtful";
  json["reason"] = found.is_believed() ? Json() : Json(verdict_of(found).substr(std::string("doubtful: ").size()));
  json["position_m"] = {found.T_a_b.translation_m.x(), found.T_a_b.translation_m.y(), found.T_a_b.translation_m.z()};
  json["roll_pitch_yaw_deg"] = {deg_from_rad(turns.x()), deg_from_rad(turns.y()), deg_from_rad(turns.z())};
  json["quaternion_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
  json["sigma_m"] = {found.sigma[0], found.sigma[1], found.sigma[2]};
  json["sigma_deg"] = {deg_from_rad(found.sigma[3]), deg_from_rad(found.sigma[4]), deg_from_rad(found.sigma[5])};
  json["start"] = fit_json(found.before);
  json["end"] = fit_json(found.after);
  json["elsewhere"] = elsewhere_json(found);
  json["held_least"] = {{"direction", weakest_direction(found)}, {"share", found.weakest_share}};
  return json_text(json);
}

void write_moved(const std::string& path, const Cloud& cloud, const Pose3& T_a_b) {
  CloudWriter writer(path, find_cloud_format(path));
  for (CloudPoint point : cloud) {
    const Point3 at = T_a_b * to_position(point);
    point.x_m = static_cast<float>(at.x());
    point.y_m = static_cast<float>(at.y());
    point.z_m = static_cast<float>(at.z());
    writer.add({&point, 1});
  }
  writer.finish();
}

int register_pair(const RegisterCommand& command) {
  AlignmentOptions options = make_options(command);
  if (!command.output.empty()) static_cast<void>(find_cloud_format(command.output));
  if (!command.picture.empty()) check_drawing_file("--picture", command.picture);
  WrittenFiles written({command.fixed, command.moved}, command.force);
  written.add("--output", command.output);
  written.add("--picture", command.picture);
  const GivenCloud fixed = read_given(command.fixed);
  const GivenCloud moved = read_given(command.moved);
  if (fixed.origin_m != moved.origin_m) {
    throw InputError({moved.file, 0}, "lies in another square kilometre than " + printable(fixed.file) +
                                          "; subtract the same offset from both");
  }
  remark_origin(fixed.file, fixed.origin_m);
  const std::unique_ptr<Backend> backend = make_backend(command.device);
  add_places(fixed.points, moved.points, *backend, options);
  const Alignment found = align_clouds(fixed.points, moved.points, options, *backend);
  if (!command.output.empty()) write_moved(command.output, moved.points, found.T_a_b);
  const std::string text = as_text(command, found);
  if (!command.picture.empty()) {
    const Canvas picture = draw_alignment(text.substr(0, text.find('\n')), fixed.points, moved.points,
                                          options.starts.front().T_a_b, found);
    write_file_atomically(command.picture, drawing_bytes(picture, command.picture, kDensePng));
  }
  print_result(command.json ? as_json(found) : text);
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void add_register_command(CLI::App& app, CommandContext& context) {
  auto options = std::make_shared<RegisterCommand>();
  CLI::App* command = add_command(app, "register", "Find the pose of a cloud in another one that overlaps it");
  command->add_option("fixed", options->fixed, "The cloud that stays: PLY, PCD or NDT, or a run with a cloud")
      ->required()
      ->type_name("CLOUD");
  command->add_option("moved", options->moved, "The cloud whose pose in it is looked for, or a run with a cloud")
      ->required()
      ->type_name("CLOUD");
  CLI::Option* const method =
      command
          ->add_option(
              "--method", options->method,
              "How: ndt (normal distributions of cubes of 2 m to 25 cm), plane (points and planes, from a start\n"
              "within a few centimetres), both (one after the other)")
          ->check(CLI::IsMember({"ndt", "plane", "both"}).description(""))
          ->type_name("NAME")
          ->capture_default_str();
  offer_words(method, {"ndt", "plane", "both"});
  command
      ->add_option("--dof", options->dof,
                   "Numbers that are looked for: 6, or 3 where both clouds stand upright at one height")
      ->check(CLI::IsMember({3, 6}).description("3 or 6"))
      ->type_name("N")
      ->capture_default_str();
  command
      ->add_option("--start", options->start,
                   "Where the moved cloud lies about, to a metre and 30 degrees [searched everywhere, by its walls]")
      ->type_name("X,Y,Z,ROLL,PITCH,YAW");
  command
      ->add_option("-o,--output", options->output, "Write the moved cloud in the frame of the fixed one: .ply or .pcd")
      ->type_name("FILE");
  command
      ->add_option("--picture", options->picture,
                   "Draw both clouds from above and from the side, at the start and at the result: .svg, .png or .pdf")
      ->type_name("FILE");
  add_device_options(*command, options->device);
  add_force_option(*command, options->force);
  command->add_flag("--json", options->json, "Print the result as JSON");
  command->footer(
      "The pose is that of the moved cloud's frame in the fixed one's: its origin there, and its roll, pitch and yaw.\n"
      "sigma is what the noise of the points leaves open, not what a bent cloud does. 'held least' is the direction\n"
      "that the surfaces hold least: along a bare corridor nothing holds a cloud, and the verdict says so.\n"
      "\n"
      "Examples:\n"
      "  gdtslam register monday tuesday -o tuesday-in-monday.ply\n"
      "  gdtslam register scan0.ply scan1.ply --start 1.5m,0,0,0,0,10deg --picture pair.png");
  command->callback([options, &context] { context.run = [options] { return register_pair(*options); }; });
}

}  // namespace gdtslam
