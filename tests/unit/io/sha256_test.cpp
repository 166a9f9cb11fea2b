// SHA-256 on the published vectors, and what the hashes of results cover.
#include "engine/io/sha256.hpp"

#include <gtest/gtest.h>

namespace gdtslam {
namespace {

std::string hash(std::string_view text) { return Sha256().update(text).hex(); }

TEST(Sha256, GivesThePublishedVectors) {
  // FIPS 180-4 examples and NIST's long messages.
  EXPECT_EQ(hash(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(
      hash("abcdefghbcdefghicdefghijdefghijkefghijklfghijklmghijklmnhijklmnoijklmnopjklmnopqklmnopqrlmnopqrsmnopqrst"
           "nopqrstu"),
      "cf5b16a778af8380036ce59e7b0492370b249b11e8f07a51afac45037afee9d1");
  EXPECT_EQ(hash(std::string(1000000, 'a')), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, FieldCoversGeometryAndCellsButNoPadding) {
  const std::vector<std::uint16_t> cells = {1, 2, 7, 3, 4, 7};
  const std::vector<std::uint16_t> other_padding = {1, 2, 9, 3, 4, 9};
  const std::vector<std::uint16_t> packed = {1, 2, 3, 4};
  const GridGeometry geometry{0.05, 1.0, 2.0, 2, 2};
  const std::string expected = Sha256()
                                   .update(0.05)
                                   .update(1.0)
                                   .update(2.0)
                                   .update(2)
                                   .update(2)
                                   .update(std::uint16_t{1})
                                   .update(std::uint16_t{2})
                                   .update(std::uint16_t{3})
                                   .update(std::uint16_t{4})
                                   .hex();
  EXPECT_EQ(sha256_of(rows_of(DistanceFieldView{geometry, 3, cells, 100})), expected);
  EXPECT_EQ(sha256_of(rows_of(DistanceFieldView{geometry, 3, other_padding, 100})), expected);
  EXPECT_EQ(sha256_of(rows_of(DistanceFieldView{geometry, 2, packed, 100})), expected);
  GridGeometry moved = geometry;
  moved.origin_x_m = 1.05;
  EXPECT_NE(sha256_of(rows_of(DistanceFieldView{moved, 2, packed, 100})), expected);
}

TEST(Sha256, TrajectoryCoversThePosesInOrder) {
  const Trajectory trajectory = {{5.0, {1.0, 2.0, 3.0}}, {6.0, {4.0, 5.0, 6.0}}};
  EXPECT_EQ(sha256_of(trajectory),
            Sha256().update(1.0).update(2.0).update(3.0).update(4.0).update(5.0).update(6.0).hex());
}

}  // namespace
}  // namespace gdtslam
