// Draws a square with Cairo and looks for its colour: the viewer links with all that it needs.
#include <cstdint>
#include <iostream>

#include "gdtslam/drawing/canvas.hpp"

int main() {
  gdtslam::Canvas drawing(40.0, 30.0, "square");
  drawing.rectangle({10.0, 5.0}, 20.0, 20.0, gdtslam::Fill{gdtslam::colour_for(0x2060a0)});
  const gdtslam::RgbaImage image = gdtslam::rasterise(drawing);
  const std::uint8_t* const inside = image.at(20, 15);
  const std::uint8_t* const outside = image.at(2, 2);
  std::cout << image.width << " by " << image.height << " pixels\n";
  return inside[0] == 0x20 && inside[1] == 0x60 && inside[2] == 0xa0 && inside[3] == 255 && outside[3] == 0 ? 0 : 1;
}
