// Models for other programs, taken apart by a JSON parser: counts, bounds, places, colours.
#include "tools/gdtslam/render/files/glb.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gdtslam/core/error.hpp"

namespace gdtslam {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class GlbTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("gdtslam-model-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    for (int k = 0; k < 10; ++k) {
      const auto v = static_cast<float>(k);
      cloud_.push_back({1.0F + v, -2.0F * v, 0.25F * v, 0.01F * v, 100.0 + 0.5 * k, static_cast<std::uint32_t>(7 + k)});
      colours_.push_back({static_cast<std::uint8_t>(20 * k), 128, 255});
    }
    path_ = {{1.0, {0.5, 1.5, 0.0}}, {2.0, {1.0, 2.0, 0.0}}, {3.0, {1.5, 4.0, 0.0}}};
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string file(const char* name) const { return (folder_ / name).string(); }
  [[nodiscard]] CloudModel model() const { return {"a \"cloud\" <&>", cloud_, colours_, &path_}; }

  fs::path folder_;
  Cloud cloud_;
  std::vector<Colour> colours_;
  Trajectory path_;
};

/// The two chunks of a .glb, section 4.4 of glTF 2.0.
struct Glb {
  explicit Glb(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    const std::string all{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    std::uint32_t text_bytes = 0;
    std::memcpy(&text_bytes, all.data() + 12, sizeof text_bytes);
    json = Json::parse(all.substr(20, text_bytes));
    bytes = all.substr(28 + text_bytes);
  }
  Json json;
  std::string bytes;
};

template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value{};
  EXPECT_LE(offset + sizeof(T), bytes.size());
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

TEST_F(GlbTest, HoldsEveryPointWithYUp) {
  write_cloud_glb(file("a.glb"), model());
  const auto [gltf, bytes] = Glb(file("a.glb"));
  EXPECT_EQ(gltf["asset"]["version"], "2.0");
  EXPECT_EQ(gltf["scenes"][0]["name"], "a \"cloud\" <&>");
  ASSERT_EQ(bytes.size(), gltf["buffers"][0]["byteLength"].get<std::size_t>());
  ASSERT_EQ(bytes.size(), 10U * (12 + 8) + 3U * 12);
  for (std::size_t k = 0; k < 10; ++k) {
    const auto v = static_cast<float>(k);
    EXPECT_EQ(value_at<float>(bytes, 12 * k), 1.0F + v);
    EXPECT_EQ(value_at<float>(bytes, 12 * k + 4), 0.25F * v);  // up
    EXPECT_EQ(value_at<float>(bytes, 12 * k + 8), 2.0F * v);   // towards the viewer
  }
  const std::size_t path = 200;
  EXPECT_EQ(value_at<float>(bytes, path), 0.5F);
  EXPECT_EQ(value_at<float>(bytes, path + 4), 0.0F);
  EXPECT_EQ(value_at<float>(bytes, path + 8), -1.5F);
  EXPECT_EQ(gltf["accessors"][0]["min"], Json::parse("[1, 0, 0]"));
  EXPECT_EQ(gltf["accessors"][0]["max"], Json::parse("[10, 2.25, 18]"));
  EXPECT_EQ(gltf["accessors"][2]["min"], Json::parse("[0.5, 0, -4]"));
}

TEST_F(GlbTest, ColoursAreLinear) {
  write_cloud_glb(file("a.glb"), model());
  const std::string bytes = Glb(file("a.glb")).bytes;
  for (std::size_t k = 0; k < 10; ++k) {
    const std::size_t at = 120 + 8 * k;
    const double share = 20.0 * static_cast<double>(k) / 255.0;
    const double linear = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(value_at<std::uint16_t>(bytes, at), 65535.0 * linear, 0.51);
    EXPECT_NEAR(value_at<std::uint16_t>(bytes, at + 2), 14146.0, 1.0);  // 128 of 255 is 0.2159 of the light
    EXPECT_EQ(value_at<std::uint16_t>(bytes, at + 4), 65535);
    EXPECT_EQ(value_at<std::uint16_t>(bytes, at + 6), 65535);
  }
}

TEST_F(GlbTest, NothingIsWrittenWithoutPointsOrPlace) {
  cloud_.clear();
  colours_.clear();
  EXPECT_THROW(write_cloud_glb(file("a.glb"), model()), InputError);
  EXPECT_TRUE(fs::is_empty(folder_));
  cloud_.push_back({});
  colours_.emplace_back();
  EXPECT_THROW(write_cloud_glb(file("no/a.glb"), model()), FileError);
}

}  // namespace
}  // namespace gdtslam
