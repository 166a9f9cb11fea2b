#include "options.hpp"

#include <memory>

#include "convert.hpp"
#include "gdtslam/io/config_yaml.hpp"
#include "guard.hpp"

namespace gdtslam::c {

Settings read_settings(const gdtslam_options* options) {
  Settings settings = options == nullptr ? Settings() : options->settings;
  require_valid(settings);
  return settings;
}

}  // namespace gdtslam::c

using namespace gdtslam::c;

gdtslam_status gdtslam_options_new(gdtslam_options** options, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(options, "gdtslam_options_new: options");
    *options = std::make_unique<gdtslam_options>().release();
  });
}

void gdtslam_options_free(gdtslam_options* options) { delete options; }

gdtslam_status gdtslam_options_set(gdtslam_options* options, const char* path, const char* value,
                                   gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_set: options");
    require(path, "gdtslam_options_set: path");
    require(value, "gdtslam_options_set: value");
    const std::string set = gdtslam::set_option(options->table, std::string(path) + "=" + value);
    options->settings.from_sets.push_back(set);
  });
}

gdtslam_status gdtslam_options_read(gdtslam_options* options, const char* file, gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_read: options");
    require(file, "gdtslam_options_read: file");
    options->settings.from_file = gdtslam::read_config(file, options->table);
  });
}

size_t gdtslam_options_count(const gdtslam_options* options) { return options == nullptr ? 0 : options->table.size(); }

gdtslam_status gdtslam_options_at(gdtslam_options* options, size_t index, gdtslam_option* option,
                                  gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_at: options");
    if (index >= options->table.size()) {
      throw gdtslam::UsageError("gdtslam_options_at: there is no option " + std::to_string(index) + ", only " +
                                std::to_string(options->table.size()));
    }
    const gdtslam::Option& row = options->table[index];
    options->path = row.path;
    options->doc = row.doc;
    options->value = gdtslam::value_text(row);
    write_struct<gdtslam_option>(
        {.size = 0, .path = options->path.c_str(), .doc = options->doc.c_str(), .value = options->value.c_str()},
        option, "gdtslam_options_at: option");
  });
}

gdtslam_status gdtslam_options_add_topic(gdtslam_options* options, const char* topic, gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_add_topic: options");
    require(topic, "gdtslam_options_add_topic: topic");
    options->settings.log.topics.scans.emplace_back(topic);
  });
}

gdtslam_status gdtslam_options_set_odometry(gdtslam_options* options, const char* topic, gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_set_odometry: options");
    options->settings.log.topics.odometry = to_text(topic);
  });
}

gdtslam_status gdtslam_options_set_crank(gdtslam_options* options, const char* topic, gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_set_crank: options");
    options->settings.log.topics.crank = to_text(topic);
  });
}

gdtslam_status gdtslam_options_add_mount(gdtslam_options* options, const char* topic, const gdtslam_pose* T_base_laser,
                                         gdtslam_error* error) {
  return guarded(error, [&] {
    require(options, "gdtslam_options_add_mount: options");
    require(T_base_laser, "gdtslam_options_add_mount: T_base_laser");
    const gdtslam::Pose2 mount = to_pose(*T_base_laser);
    if (!mount.is_finite()) throw gdtslam::InputError("gdtslam_options_add_mount: T_base_laser is not finite");
    gdtslam::LogConfig& log = options->settings.log;
    if (topic == nullptr) {
      log.mount = gdtslam::LogSource::kStated;
      log.T_base_laser = mount;
    } else {
      log.topics.mounts.push_back({topic, mount});
    }
  });
}
