// The file of normal distributions: bytes by the description of docs/formats.md, parts that join, damaged files.
#include "engine/runs/registration/ndt_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>

#include "engine/io/sha256.hpp"
#include "gdtslam/core/error.hpp"
#include "support/cloud_scenes.hpp"

namespace gdtslam {
namespace {

using test::Rectangle;

class NdtFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  void put(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  [[nodiscard]] std::string written(const NdtMap& map) const {
    EXPECT_GT(write_ndt(path_, map), 0U);
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

  const std::string path_ = std::filesystem::temp_directory_path() / ("gdtslam-" + std::to_string(::getpid()) + ".ndt");
};

Cloud room_cloud() {
  Random random(11);
  Cloud cloud;
  for (const Rectangle& side : test::room({5.0, 4.0, 2.5})) test::strew(cloud, side, 3'000, 0.01, random);
  return cloud;
}

// One byte after the other, as docs/formats.md says; one point at (0.5 m, 0.25 m, -0.25 m) and cubes of 1.024 m.
std::string bytes_by_hand() {
  std::string bytes = "gdtslam-ndt-cube";
  const auto append = [&bytes](std::uint64_t value, int count) {
    for (int k = 0; k < count; ++k) bytes += static_cast<char>((value >> (8 * k)) & 0xffU);
  };
  const auto varint = [&bytes](std::uint64_t value) {
    for (; value > 127; value /= 128) bytes += static_cast<char>(value % 128 + 128);
    bytes += static_cast<char>(value);
  };
  append(1, 4);
  append(std::bit_cast<std::uint64_t>(1.024), 8);
  append(1, 4);
  const std::uint64_t zero = 1 << 20;
  varint((((zero << 21) + zero) << 21) + zero - 1);
  varint(1);
  // The centre is (0.512, 0.512, -0.512): steps of 1 mm from it are (-12, -262, 262).
  for (const std::uint64_t sum : {2U * 12 + 1, 2U * 262 + 1, 2U * 262}) varint(sum);
  for (const std::uint64_t product :
       {12U * 12, 2U * 12 * 262, 2U * 12 * 262 + 1, 262U * 262, 2U * 262 * 262 + 1, 262U * 262}) {
    varint(product);
  }
  return bytes + Sha256().update(bytes).hex();
}

TEST_F(NdtFile, HasTheBytesOfTheDescription) {
  NdtMap map(1.024);
  map.add(Cloud{{.x_m = 0.5F, .y_m = 0.25F, .z_m = -0.25F}});
  EXPECT_EQ(written(map), bytes_by_hand());
}

TEST_F(NdtFile, GivesBackWhatWasWritten) {
  NdtMap map(0.25);
  map.add(room_cloud());
  const std::string bytes = written(map);
  const NdtMap again = read_ndt(path_);
  EXPECT_EQ(again.cubes(), map.cubes());
  EXPECT_EQ(again.cell_m(), 0.25);
  EXPECT_EQ(again.points(), map.points());
  EXPECT_LT(static_cast<double>(bytes.size()), 40.0 * static_cast<double>(map.size()));
}

TEST_F(NdtFile, PartsInAnyOrderJoinToTheBytesOfTheWhole) {
  const Cloud cloud = room_cloud();
  NdtMap whole(0.5);
  whole.add(cloud);
  NdtMap joined(0.5);
  const std::size_t third = cloud.size() / 3;
  for (const std::size_t k : {2U, 0U, 1U}) {
    NdtMap part(0.5);
    part.add(std::span(cloud).subspan(k * third, third));
    static_cast<void>(written(part));
    joined.merge(read_ndt(path_));
  }
  EXPECT_EQ(written(joined), written(whole));
}

TEST_F(NdtFile, ADamagedFileIsRefused) {
  const std::string whole = bytes_by_hand();
  for (std::size_t k = 0; k < whole.size(); ++k) {
    std::string changed = whole;
    changed[k] = static_cast<char>(changed[k] ^ 1);
    put(changed);
    EXPECT_THROW(static_cast<void>(read_ndt(path_)), InputError) << k;
    put(whole.substr(0, k));
    EXPECT_THROW(static_cast<void>(read_ndt(path_)), InputError) << k;
  }
}

// With the right checksum: one that no map has is refused, any other is read.
TEST_F(NdtFile, ImpossibleCubesAreRefused) {
  const std::string whole = bytes_by_hand();
  const std::string body = whole.substr(0, whole.size() - 64);
  int refused = 0;
  for (std::size_t k = 20; k < body.size(); ++k) {  // from the edge on
    for (const int value : {0x00, 0x7f, 0xff}) {
      std::string changed = body;
      changed[k] = static_cast<char>(value);
      put(changed + Sha256().update(changed).hex());
      try {
        EXPECT_EQ(read_ndt(path_).size(), 1U) << k;
      } catch (const InputError&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 60);
}

}  // namespace
}  // namespace gdtslam
