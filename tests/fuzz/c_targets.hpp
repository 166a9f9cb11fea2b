// The C interface: bytes are a program of calls, in any order, with handles that are there or NULL, structs that are
// cut short and numbers of any kind.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gdtslam.h"
#include "target.hpp"

namespace gdtslam::fuzz {
namespace detail {

/// Arguments out of what is left of the input; zeros behind its end.
class Arguments {
 public:
  explicit Arguments(std::span<const std::byte> data) : rest_(data) {}
  [[nodiscard]] bool is_over() const { return rest_.empty(); }
  template <class Value>
  Value value() {
    Value value{};
    const std::size_t count = std::min(sizeof(value), rest_.size());
    std::memcpy(&value, rest_.data(), count);
    rest_ = rest_.subspan(count);
    return value;
  }
  std::uint8_t byte() { return value<std::uint8_t>(); }
  /// Up to a 0.
  std::string text() {
    std::string text;
    while (const std::uint8_t letter = byte()) text += static_cast<char>(letter);
    return text;
  }
  gdtslam_pose pose() { return {value<float>(), value<float>(), value<float>()}; }

 private:
  std::span<const std::byte> rest_;
};

/// A struct whose caller may be of an older version: of the size that a byte says, at most its own.
template <class Struct>
Struct sized(Arguments& arguments) {
  Struct made;
  GDTSLAM_INIT(made);
  const std::uint8_t size = arguments.byte();
  if (size != 0) made.size = std::min<std::size_t>(size, sizeof(made));
  return made;
}

/// What the calls work on; a handle of each kind.
class Calls {
 public:
  Calls(std::span<const std::byte> data, const ScratchFolder& folder) : in_(data), folder_(folder) {}
  Calls(const Calls&) = delete;
  Calls& operator=(const Calls&) = delete;
  ~Calls() {
    gdtslam_options_free(options_);
    gdtslam_reader_free(reader_);
    gdtslam_mapper_free(mapper_);
    gdtslam_grid_free(grid_);
    gdtslam_run_free(run_);
    gdtslam_localizer_free(localizer_);
    gdtslam_tracker_free(tracker_);
    gdtslam_bytes_free(bytes_);
  }

  void run() {
    constexpr std::array kCalls{
        &Calls::set_option, &Calls::read_options,   &Calls::look_at_option,  &Calls::choose_topics,
        &Calls::open_log,   &Calls::next_scan,      &Calls::look_at_warning, &Calls::make_mapper,
        &Calls::map_scan,   &Calls::close_mapper,   &Calls::look_at_mapper,  &Calls::look_at_grid,
        &Calls::open_run,   &Calls::make_localizer, &Calls::localize_scan,   &Calls::free_one};
    for (int calls = 0; calls < kMostCalls && !in_.is_over(); ++calls) {
      GDTSLAM_INIT(error_);
      (this->*kCalls[in_.byte() % kCalls.size()])();
    }
  }

 private:
  static constexpr int kMostCalls = 64;
  static constexpr int kMostScans = 12;  // each takes milliseconds

  /// A status that there is, and a text of one line where it is none of success.
  gdtslam_status checked(gdtslam_status status) const {
    require(std::string_view(gdtslam_status_name(status)) != "unknown status");
    require(status == error_.status);
    require((status == GDTSLAM_OK) == (error_.text[0] == '\0'), error_.text);
    require(is_one_line(error_.text), error_.text);
    require(status != GDTSLAM_FAILED && status != GDTSLAM_INPUT_OUTPUT, error_.text);
    return status;
  }
  bool is_null() { return in_.byte() == 255; }

  void set_option() {
    if (options_ == nullptr) checked(gdtslam_options_new(&options_, &error_));
    const std::string path = in_.text();
    const std::string value = in_.text();
    checked(gdtslam_options_set(options_, path.c_str(), value.c_str(), &error_));
  }
  void read_options() {
    const std::string file = folder_.put("config.yaml", in_.text());
    checked(gdtslam_options_read(options_, file.c_str(), &error_));
  }
  void look_at_option() {
    auto option = sized<gdtslam_option>(in_);
    checked(gdtslam_options_at(options_, in_.byte(), is_null() ? nullptr : &option, &error_));
    require(gdtslam_options_count(nullptr) == 0);
  }
  void choose_topics() {
    const std::string topic = in_.text();
    const gdtslam_pose mount = in_.pose();
    checked(gdtslam_options_add_topic(options_, topic.c_str(), &error_));
    checked(gdtslam_options_set_odometry(options_, is_null() ? nullptr : topic.c_str(), &error_));
    checked(gdtslam_options_set_crank(options_, topic.c_str(), &error_));
    checked(gdtslam_options_add_mount(options_, is_null() ? nullptr : topic.c_str(), &mount, &error_));
  }
  void open_log() {
    gdtslam_reader_free(reader_);
    reader_ = nullptr;
    const std::string log = folder_.put("log", in_.text());
    const std::array<const char*, 2> logs{log.c_str(), log.c_str()};
    const std::uint32_t flags = in_.byte() % 4U;
    checked(gdtslam_reader_open(logs.data(), in_.byte() % 3U, options_, flags, &reader_, &error_));
  }
  void next_scan() {
    auto scan = sized<gdtslam_scan>(in_);
    std::int32_t has_scan = 0;
    checked(gdtslam_reader_next(reader_, is_null() ? nullptr : &scan, &has_scan, &error_));
    require(gdtslam_reader_progress(nullptr) < 0.0);
    if (has_scan != 0 && scan.size > offsetof(gdtslam_scan, range_count) + sizeof(scan.range_count)) {
      for (std::size_t k = 0; k < scan.range_count; ++k) require(scan.ranges_m[k] >= 0.0F);
    }
  }
  void look_at_warning() {
    auto warning = sized<gdtslam_log_warning>(in_);
    std::int32_t has_warning = 0;
    checked(gdtslam_reader_warning(reader_, in_.byte(), &warning, &has_warning, &error_));
  }

  /// Most of a scan as a laser gives it, then some numbers as the input has them.
  gdtslam_scan scan() {
    auto scan = sized<gdtslam_scan>(in_);
    ranges_m_.assign(in_.byte(), 0.0F);
    for (float& range_m : ranges_m_) range_m = 0.05F * static_cast<float>(in_.byte());
    const std::uint8_t odd = in_.byte();
    if ((odd & 1U) != 0 && !ranges_m_.empty()) ranges_m_[in_.byte() % ranges_m_.size()] = in_.value<float>();
    scan.ranges_m = (odd & 2U) != 0 ? nullptr : ranges_m_.data();
    scan.range_count = ranges_m_.size();
    scan.stamp_s = (odd & 4U) != 0 ? in_.value<double>() : stamp_s_ += 0.1;
    scan.first_bearing_rad = (odd & 8U) != 0 ? in_.value<double>() : -1.5;
    scan.bearing_step_rad = (odd & 16U) != 0 ? in_.value<double>() : 0.02;
    scan.max_range_m = (odd & 32U) != 0 ? double{in_.value<float>()} : 0.0;
    scan.has_odometry = in_.byte() % 2;
    if ((odd & 64U) != 0) scan.T_odom_base = in_.pose();
    if ((odd & 128U) != 0) {
      scan.T_base_laser = in_.pose();
      scan.beam_period_s = in_.value<float>();
      scan.has_speed = in_.byte() % 2;
      scan.speed = in_.pose();
      scan.laser = in_.byte();
    }
    return scan;
  }
  void make_mapper() {
    gdtslam_mapper_free(mapper_);
    mapper_ = nullptr;
    auto request = sized<gdtslam_mapper_request>(in_);
    request.flags = in_.byte();
    request.threads = 1;
    checked(gdtslam_mapper_new(is_null() ? nullptr : &request, &mapper_, &error_));
  }
  void map_scan() {
    const gdtslam_scan given = scan();
    auto match = sized<gdtslam_match>(in_);
    if (++scans_ > kMostScans) return;
    checked(gdtslam_mapper_process(mapper_, &given, &match, &error_));
  }
  void close_mapper() { checked(gdtslam_mapper_close(mapper_, nullptr, nullptr, &error_)); }
  void look_at_mapper() {
    const gdtslam_stamped_pose* poses = nullptr;
    std::size_t count = 0;
    if (checked(gdtslam_mapper_trajectory(mapper_, &poses, &count, &error_)) == GDTSLAM_OK) {
      for (std::size_t k = 0; k < count; ++k) require(poses[k].x_m == poses[k].x_m, "a pose is not a number");
    }
    gdtslam_grid_free(grid_);
    checked(gdtslam_mapper_field(mapper_, &grid_, &error_));
  }
  void look_at_grid() {
    auto view = sized<gdtslam_grid_view>(in_);
    checked(gdtslam_grid_look(grid_, &view, &error_));
    require(gdtslam_grid_sha256(grid_) != nullptr);
  }
  void open_run() {
    folder_.put("report.json", in_.text());
    gdtslam_run_free(run_);
    run_ = nullptr;
    checked(gdtslam_run_open(folder_.path().c_str(), &run_, &error_));
    if (run_ == nullptr) return;
    const gdtslam_stamped_pose* poses = nullptr;
    std::size_t count = 0;
    checked(gdtslam_run_trajectory(run_, &poses, &count, &error_));
    require(gdtslam_run_report(run_) != nullptr && gdtslam_run_folder(run_) != nullptr);
  }
  void make_localizer() {
    gdtslam_localizer_free(localizer_);
    localizer_ = nullptr;
    gdtslam_tracker_free(tracker_);
    tracker_ = nullptr;
    auto request = sized<gdtslam_localizer_request>(in_);
    const std::string map = folder_.file(in_.byte() % 2 == 0 ? "map.yaml" : "none.yaml");
    request.map = map.c_str();
    request.flags = in_.byte();
    request.reserved = in_.byte() / 128U;
    request.gap_m = in_.value<float>();
    request.max_seconds = 0.05;
    request.good_fit_m = in_.value<float>();
    const gdtslam_status status = gdtslam_localizer_new(&request, &localizer_, &error_);
    if (status != GDTSLAM_INPUT_OUTPUT) checked(status);  // a map that is not there
  }
  void localize_scan() {
    const gdtslam_scan given = scan();
    auto location = sized<gdtslam_location>(in_);
    auto tracked = sized<gdtslam_tracked>(in_);
    if (++scans_ > kMostScans) return;
    checked(gdtslam_localizer_find(localizer_, &given, &location, &error_));
    if (tracker_ == nullptr) checked(gdtslam_tracker_new(localizer_, &tracker_, &error_));
    checked(gdtslam_tracker_follow(tracker_, &given, &tracked, &error_));
  }
  void free_one() {
    gdtslam_options_free(options_);
    options_ = nullptr;
    gdtslam_grid_free(grid_);
    grid_ = nullptr;
  }

  Arguments in_;
  const ScratchFolder& folder_;
  gdtslam_error error_{};
  gdtslam_options* options_ = nullptr;
  gdtslam_reader* reader_ = nullptr;
  gdtslam_mapper* mapper_ = nullptr;
  gdtslam_grid* grid_ = nullptr;
  gdtslam_run* run_ = nullptr;
  gdtslam_localizer* localizer_ = nullptr;
  gdtslam_tracker* tracker_ = nullptr;
  gdtslam_bytes* bytes_ = nullptr;
  std::vector<float> ranges_m_;
  double stamp_s_ = 0.0;
  int scans_ = 0;
};

}  // namespace detail

inline void call_c_interface(std::span<const std::byte> data) {
  static const ScratchFolder folder;
  static const bool is_ready = [] {
    std::string image = "P5\n40 40\n255\n";
    for (int cell = 0; cell < 40 * 40; ++cell) image += cell % 40 == 0 || cell < 40 ? '\x00' : '\xfe';
    folder.put("map.pgm", image);
    folder.put("map.yaml", "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\noccupied_thresh: 0.65\n");
    return true;
  }();
  require(is_ready);
  detail::Calls(data, folder).run();
}

inline constexpr std::array kCTargets{FuzzTarget{"c_calls", call_c_interface, 5}};

}  // namespace gdtslam::fuzz
