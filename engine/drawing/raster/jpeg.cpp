#include <turbojpeg.h>

#include <fmt/format.h>

#include <memory>

#include "gdtslam/core/error.hpp"
#include "jpeg.hpp"

namespace gdtslam {
namespace {

constexpr int kQuality = 92;  ///< of 100: lines and letters have no halo that shows

struct CloseJpeg {
  void operator()(void* handle) const { tjDestroy(handle); }
};
struct FreeJpeg {
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};

}  // namespace

std::string jpeg_of(const RgbaImage& image) {
  const std::unique_ptr<void, CloseJpeg> handle(tjInitCompress());
  if (!handle) throw Error(ExitCode::kFailed, fmt::format("libjpeg-turbo fails: {}", tjGetErrorStr2(nullptr)));
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  // Colours at full resolution: a red line of one pixel beside a blue one keeps its colour.
  const int failed =
      tjCompress2(handle.get(), image.pixels.data(), static_cast<int>(image.width), 0, static_cast<int>(image.height),
                  TJPF_RGBX, &bytes, &size, TJSAMP_444, kQuality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, FreeJpeg> made(bytes);
  if (failed != 0) throw Error(ExitCode::kFailed, fmt::format("no JPEG: {}", tjGetErrorStr2(handle.get())));
  return {made.get(), made.get() + size};
}

}  // namespace gdtslam
