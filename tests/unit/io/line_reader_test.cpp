// Lines out of bytes that come in pieces of any size: the same lines, whatever the pieces.
#include "engine/io/line_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/io/logs/steady_mount.hpp"
#include "gdtslam/core/angle.hpp"

namespace gdtslam {
namespace {

using ::testing::ElementsAre;

/// Gives at most `piece` bytes at a time, as a pipe may.
class PieceSource final : public ByteSource {
 public:
  PieceSource(std::string text, std::size_t piece) : text_(std::move(text)), piece_(piece) {}
  std::size_t read(std::span<char> target) override {
    const std::size_t count = text_.copy(target.data(), std::min(target.size(), piece_), position_);
    position_ += count;
    return count;
  }
  [[nodiscard]] double progress() const override { return -1.0; }
  [[nodiscard]] std::uint64_t bytes_from_file() const override { return position_; }

 private:
  std::string text_;
  std::size_t piece_;
  std::size_t position_ = 0;
};

LineReader reader_of(const std::string& text, std::size_t piece, std::size_t most_line_bytes = 10) {
  return {std::make_unique<PieceSource>(text, piece), most_line_bytes};
}

/// "number:text", with "~" behind a line without its end and "+" behind one that is too long.
std::vector<std::string> lines_of(LineReader reader) {
  std::vector<std::string> told;
  while (const std::optional<TextLine> line = reader.next()) {
    const std::string text(line->is_too_long ? line->text.substr(0, 10) : line->text);
    told.push_back(std::to_string(line->number) + ":" + text + (line->has_newline ? "" : "~") +
                   (line->is_too_long ? "+" : ""));
  }
  return told;
}

TEST(LineReader, TheSizeOfThePiecesChangesNothing) {
  for (const std::size_t piece : {1U, 2U, 3U, 5U, 8U, 13U, 100U}) {
    EXPECT_THAT(lines_of(reader_of("a\n\nbc\r\nd\re\r", piece)), ElementsAre("1:a", "2:", "3:bc", "4:d\re\r~"))
        << piece;
    EXPECT_THAT(lines_of(reader_of("a\n", piece)), ElementsAre("1:a"));
    EXPECT_THAT(lines_of(reader_of("\r\n\r", piece)), ElementsAre("1:", "2:\r~"));
    EXPECT_THAT(lines_of(reader_of("", piece)), ElementsAre());
  }
}

TEST(LineReader, ALineOfJustTheLimitIsWholeAndALongerOneIsToldAndPassedOver) {
  for (const std::size_t piece : {1U, 4U, 11U, 100U}) {
    EXPECT_THAT(lines_of(reader_of("0123456789\nb\n", piece)), ElementsAre("1:0123456789", "2:b")) << piece;
    EXPECT_THAT(lines_of(reader_of("0123456789", piece)), ElementsAre("1:0123456789~"));
    for (const std::size_t more : {1U, 2U, 50U, 20000U}) {
      const std::vector<std::string> told =
          lines_of(reader_of("0123456789" + std::string(more, 'x') + "\nb\nc", piece));
      ASSERT_EQ(told.size(), 3U) << piece << ' ' << more;
      EXPECT_TRUE(told[0].starts_with("1:0123456789") && told[0].ends_with("+"));
      EXPECT_EQ(told[1], "2:b");
      EXPECT_EQ(told[2], "3:c~");
    }
  }
}

TEST(LineReader, EmptyLinesAreCountedAsTheyArePassed) {
  for (const std::size_t piece : {1U, 3U, 100U}) {
    LineReader reader = reader_of("\n\n\na\n\nb", piece);
    EXPECT_EQ(reader.skip_empty_lines(), 3U);
    EXPECT_EQ(reader.next()->text, "a");
    EXPECT_EQ(reader.skip_empty_lines(), 5U);
    const TextLine last = reader.next().value();
    EXPECT_EQ(last.number, 6U);
    EXPECT_EQ(last.text, "b");
    EXPECT_EQ(reader.skip_empty_lines(), 6U);
    EXPECT_FALSE(reader.next());
  }
}

TEST(LineReader, BytesAndLinesMayFollowEachOther) {
  for (const std::size_t piece : {1U, 3U, 100U}) {
    LineReader reader = reader_of("ab\ncdefgh", piece, 100);
    EXPECT_EQ(reader.peek(2).substr(0, 2), "ab");
    EXPECT_EQ(reader.next()->text, "ab");
    EXPECT_EQ(std::string_view(reader.peek_bytes(2), 2), "cd");
    EXPECT_EQ(std::string_view(reader.bytes(3), 3), "cde");
    EXPECT_EQ(reader.bytes(4), nullptr) << "there are three";
    std::string rest;
    for (std::string_view some = reader.some(2); !some.empty(); some = reader.some(2)) {
      EXPECT_LE(some.size(), 2U);
      rest += some;
    }
    EXPECT_EQ(rest, "fgh");
  }
}

}  // namespace
}  // namespace gdtslam
