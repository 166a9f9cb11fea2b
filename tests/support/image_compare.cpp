#include "image_compare.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include <cairo.h>
#include <fmt/format.h>

namespace gdtslam::test {
namespace {

using Pixel = std::array<int, 4>;  // red, green, blue, alpha; premultiplied

// Rounded as the PNG's way through Cairo rounds, so that a golden meets the picture it was made from.
Pixel premultiplied(const std::uint8_t* rgba) {
  const int alpha = rgba[3];
  const auto times_alpha = [alpha](int channel) { return (channel * alpha + 127) / 255; };
  return {times_alpha(rgba[0]), times_alpha(rgba[1]), times_alpha(rgba[2]), alpha};
}

Pixel absolute_difference(const std::uint8_t* a, const std::uint8_t* b) {
  const Pixel one = premultiplied(a);
  const Pixel other = premultiplied(b);
  Pixel difference{};
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] = std::abs(one[k] - other[k]);
  return difference;
}

struct SurfaceEnd {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceEnd>;

void check(cairo_status_t status, const std::string& path) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(fmt::format("{}: {}", path, cairo_status_to_string(status)));
  }
}

std::string golden_path(const std::string& name) {
  return fmt::format("{}/tests/golden/viewer/{}.png", GDTSLAM_SOURCE_DIR, name);
}

std::string size_text(const RgbaImage& image) { return fmt::format("{} x {}", image.width, image.height); }

bool is_same_size(const RgbaImage& a, const RgbaImage& b) { return a.width == b.width && a.height == b.height; }

// Where they differ, brighter; opaque, so that a lost alpha shows too.
RgbaImage difference_image(const RgbaImage& a, const RgbaImage& b) {
  RgbaImage image(a.width, a.height);
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      const Pixel difference = absolute_difference(a.at(x, y), b.at(x, y));
      for (std::size_t k = 0; k < 3; ++k) {
        image.at(x, y)[k] = static_cast<std::uint8_t>(std::min(255, 4 * std::max(difference[k], difference[3])));
      }
      image.at(x, y)[3] = 255;
    }
  }
  return image;
}

std::string write_evidence(const RgbaImage& actual, const RgbaImage* expected, const std::string& name) {
  const std::string stem = fmt::format("{}/tests/golden/{}", GDTSLAM_BINARY_DIR, name);
  std::filesystem::create_directories(std::filesystem::path(stem).parent_path());
  write_png(actual, stem + ".actual.png");
  if (expected != nullptr) write_png(*expected, stem + ".expected.png");
  if (expected != nullptr && is_same_size(actual, *expected)) {
    write_png(difference_image(actual, *expected), stem + ".difference.png");
  }
  return stem + ".*.png";
}

}  // namespace

ImageDifference difference_of(const RgbaImage& a, const RgbaImage& b, int clear_step) {
  if (!is_same_size(a, b)) {
    throw std::invalid_argument(fmt::format("pictures of {} and {}", size_text(a), size_text(b)));
  }
  double sum = 0.0;
  std::size_t clear = 0;
  for (std::uint32_t y = 0; y < a.height; ++y) {
    for (std::uint32_t x = 0; x < a.width; ++x) {
      const Pixel difference = absolute_difference(a.at(x, y), b.at(x, y));
      for (const int step : difference) sum += step;
      if (*std::max_element(difference.begin(), difference.end()) > clear_step) ++clear;
    }
  }
  const double pixels = std::max(1.0, static_cast<double>(a.width) * static_cast<double>(a.height));
  return {.mean = sum / (4.0 * pixels), .share_clear = static_cast<double>(clear) / pixels};
}

bool is_alike(const RgbaImage& actual, const RgbaImage& expected, const ImageTolerance& tolerance) {
  if (!is_same_size(actual, expected)) return false;
  const ImageDifference difference = difference_of(actual, expected, tolerance.clear_step);
  return difference.mean <= tolerance.mean && difference.share_clear <= tolerance.share_clear;
}

RgbaImage read_png(const std::string& path) {
  const Surface surface(cairo_image_surface_create_from_png(path.c_str()));
  check(cairo_surface_status(surface.get()), path);
  const cairo_format_t format = cairo_image_surface_get_format(surface.get());
  if (format != CAIRO_FORMAT_ARGB32 && format != CAIRO_FORMAT_RGB24) {
    throw std::runtime_error(path + ": not a PNG of 8 bits a channel");
  }
  RgbaImage image(static_cast<std::uint32_t>(cairo_image_surface_get_width(surface.get())),
                  static_cast<std::uint32_t>(cairo_image_surface_get_height(surface.get())));
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      std::uint32_t argb = 0;
      std::memcpy(&argb, data + y * stride + std::size_t{4} * x, sizeof argb);
      const std::uint32_t alpha = format == CAIRO_FORMAT_RGB24 ? 255U : argb >> 24U;
      const auto whole = [alpha](std::uint32_t channel) {
        return static_cast<std::uint8_t>(alpha == 0 ? 0 : std::min(255U, (channel * 255U + alpha / 2U) / alpha));
      };
      std::uint8_t* pixel = image.at(x, y);
      pixel[0] = whole(argb >> 16U & 0xFFU);
      pixel[1] = whole(argb >> 8U & 0xFFU);
      pixel[2] = whole(argb & 0xFFU);
      pixel[3] = static_cast<std::uint8_t>(alpha);
    }
  }
  return image;
}

void write_png(const RgbaImage& image, const std::string& path) {
  const Surface surface(
      cairo_image_surface_create(CAIRO_FORMAT_ARGB32, static_cast<int>(image.width), static_cast<int>(image.height)));
  check(cairo_surface_status(surface.get()), path);
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const Pixel pixel = premultiplied(image.at(x, y));
      const auto bits = [&pixel](std::size_t k) { return static_cast<std::uint32_t>(pixel[k]); };
      const std::uint32_t argb = bits(3) << 24U | bits(0) << 16U | bits(1) << 8U | bits(2);
      std::memcpy(data + y * stride + std::size_t{4} * x, &argb, sizeof argb);
    }
  }
  cairo_surface_mark_dirty(surface.get());
  check(cairo_surface_write_to_png(surface.get(), path.c_str()), path);
}

::testing::AssertionResult matches_golden(const RgbaImage& actual, const std::string& name,
                                          const ImageTolerance& tolerance) {
  const std::string path = golden_path(name);
  if (const char* update = std::getenv("GDTSLAM_UPDATE_GOLDENS"); update != nullptr && std::string(update) == "1") {
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    write_png(actual, path);
    return ::testing::AssertionSuccess() << path << " written";
  }
  if (!std::filesystem::exists(path)) {
    return ::testing::AssertionFailure() << path << " is not there; the picture is "
                                         << write_evidence(actual, nullptr, name)
                                         << "; GDTSLAM_UPDATE_GOLDENS=1 makes it the golden";
  }
  const RgbaImage expected = read_png(path);
  if (!is_same_size(actual, expected)) {
    return ::testing::AssertionFailure() << name << " is " << size_text(actual) << ", the golden "
                                         << size_text(expected) << "; see " << write_evidence(actual, &expected, name);
  }
  if (is_alike(actual, expected, tolerance)) return ::testing::AssertionSuccess();
  const ImageDifference difference = difference_of(actual, expected, tolerance.clear_step);
  return ::testing::AssertionFailure() << fmt::format(
             "{}: differs by {:.3f} in the mean (at most {}), {:.4f} of the pixels by more than {} (at most {}); see "
             "{}",
             name, difference.mean, tolerance.mean, difference.share_clear, tolerance.clear_step, tolerance.share_clear,
             write_evidence(actual, &expected, name));
}

RgbaImage golden(const std::string& name) { return read_png(golden_path(name)); }

}  // namespace gdtslam::test
