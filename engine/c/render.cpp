// Pictures of a run.
#include <memory>
#include <string>

#include "engine/runs/views/run_views.hpp"
#include "guard.hpp"
#include "run.hpp"
#include "structs.hpp"

struct gdtslam_bytes {
  std::string bytes;
};

using namespace gdtslam::c;

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
    wanted.colour_map = text_of(given.colour_map);
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
