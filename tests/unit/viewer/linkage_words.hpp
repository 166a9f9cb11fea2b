// The words of a canvas as boxes: large enough to be read, none over another or over the edge.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "gdtslam/drawing/canvas.hpp"

namespace gdtslam::test {

struct WordBox {
  double left = 0.0;
  double top = 0.0;
  double right = 0.0;
  double bottom = 0.0;
  std::string text;
};

inline std::vector<WordBox> word_boxes(const Canvas& canvas) {
  std::vector<WordBox> boxes;
  for (const Shape& shape : canvas.shapes()) {
    const auto* words = std::get_if<shape::Words>(&shape);
    if (words == nullptr || words->text.empty()) continue;
    EXPECT_FALSE(words->is_upright) << words->text;
    const double size = words->lettering.size;
    const double width = text_width(words->text, size, words->lettering.is_bold);
    const Anchor anchor = words->lettering.anchor;
    const double share = anchor == Anchor::kStart ? 0.0 : (anchor == Anchor::kEnd ? 1.0 : 0.5);
    const double left = words->at.x() - share * width;
    boxes.push_back({left, words->at.y() - 0.73 * size, left + width, words->at.y() + 0.12 * size, words->text});
  }
  return boxes;
}

inline void expect_legible(const Canvas& canvas, const std::string& what) {
  constexpr double kLeastSize = 8.0;
  const std::vector<WordBox> boxes = word_boxes(canvas);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const WordBox& a = boxes[i];
    const std::string where = what + ": " + a.text;
    EXPECT_GE(a.left, 0.0) << where;
    EXPECT_GE(a.top, 0.0) << where;
    EXPECT_LE(a.right, canvas.width()) << where;
    EXPECT_LE(a.bottom, canvas.height()) << where;
    EXPECT_GE(a.bottom - a.top, 0.85 * kLeastSize) << where;
    for (std::size_t k = 0; k < i; ++k) {
      const WordBox& b = boxes[k];
      const bool is_apart = a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
      EXPECT_TRUE(is_apart) << where << " over " << b.text;
    }
  }
}

}  // namespace gdtslam::test
