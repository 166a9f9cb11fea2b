#include "run.hpp"

#include <memory>
#include <mutex>
#include <string>

#include "convert.hpp"
#include "engine/io/byte_source.hpp"
#include "engine/runs/folder/run_files.hpp"
#include "engine/runs/folder/run_views.hpp"
#include "guard.hpp"

struct gdtslam_bytes {
  std::string bytes;
};

namespace {

std::string report_text(const gdtslam::RunReader& run) {
  const std::string file = run.files().path(gdtslam::kReportFile);
  return gdtslam::read_all(*gdtslam::open_file_source(file), gdtslam::kMostReportBytes, file);
}

}  // namespace

gdtslam_run::gdtslam_run(const std::string& folder)
    : reader(folder),
      report(report_text(reader)),
      trajectory_sha256(reader.files().report().text("trajectory_sha256")) {}

using namespace gdtslam::c;

gdtslam_status gdtslam_run_open(const char* folder, gdtslam_run** run, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(run, "gdtslam_run_open: run");
    require(folder, "gdtslam_run_open: folder");
    *run = std::make_unique<gdtslam_run>(folder).release();
  });
}

void gdtslam_run_free(gdtslam_run* run) { delete run; }

const char* gdtslam_run_folder(const gdtslam_run* run) { return run == nullptr ? "" : run->reader.folder().c_str(); }

const char* gdtslam_run_map_sha256(const gdtslam_run* run) {
  return run == nullptr ? "" : run->reader.summary().map_sha256.c_str();
}

const char* gdtslam_run_trajectory_sha256(const gdtslam_run* run) {
  return run == nullptr ? "" : run->trajectory_sha256.c_str();
}

const char* gdtslam_run_report(const gdtslam_run* run) { return run == nullptr ? "" : run->report.c_str(); }

gdtslam_status gdtslam_run_trajectory(gdtslam_run* run, const gdtslam_stamped_pose** poses, size_t* count,
                                      gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(poses, "gdtslam_run_trajectory: poses");
    require(count, "gdtslam_run_trajectory: count");
    require(run, "gdtslam_run_trajectory: run");
    const std::lock_guard lock(run->mutex);
    if (!run->trajectory) run->trajectory = to_c(run->reader.trajectory());
    *poses = run->trajectory->data();
    *count = run->trajectory->size();
  });
}

gdtslam_status gdtslam_run_map(const gdtslam_run* run, gdtslam_grid** map, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(map, "gdtslam_run_map: map");
    require(run, "gdtslam_run_map: run");
    *map = make_grid(run->reader.map()).release();
  });
}

gdtslam_status gdtslam_run_field(const gdtslam_run* run, gdtslam_grid** field, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(field, "gdtslam_run_field: field");
    require(run, "gdtslam_run_field: run");
    const gdtslam::DistanceFieldFile file = run->reader.field();
    *field = make_grid(gdtslam::rows_of(file.view())).release();
  });
}

gdtslam_status gdtslam_run_render(const gdtslam_run* run, const gdtslam_picture_request* request,
                                  gdtslam_bytes** picture, gdtslam_error* error) {
  return guarded(error, [&] {
    require_result(picture, "gdtslam_run_render: picture");
    require(run, "gdtslam_run_render: run");
    gdtslam_picture_request given{};
    if (request != nullptr) given = read_struct(request, sizeof(given.size), "gdtslam_run_render: request");
    gdtslam::RunViewRequest wanted;
    if (given.view != nullptr) wanted.view = given.view;
    if (given.title != nullptr) wanted.title = given.title;
    wanted.colour_map = to_text(given.colour_map);
    if (given.width != 0 || given.height != 0) wanted.size = gdtslam::PictureSize{given.width, given.height};
    const std::string format = given.format == nullptr ? "png" : given.format;
    auto made = std::make_unique<gdtslam_bytes>();
    made->bytes = gdtslam::picture_bytes(gdtslam::run_view(run->reader, wanted), format);
    *picture = made.release();
  });
}

const void* gdtslam_bytes_data(const gdtslam_bytes* bytes) { return bytes == nullptr ? nullptr : bytes->bytes.data(); }

size_t gdtslam_bytes_count(const gdtslam_bytes* bytes) { return bytes == nullptr ? 0 : bytes->bytes.size(); }

void gdtslam_bytes_free(gdtslam_bytes* bytes) { delete bytes; }
