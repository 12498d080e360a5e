#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "Core/Point.h"
#include "Images/Image.h"
#include "Registration/Pictures.h"

namespace crease::canvas {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
};

inline constexpr Colour kPaper{255, 255, 255};
inline constexpr Colour kInk{31, 31, 31};

Picture blank(int width, int height, Colour colour);
void set_pixel(Picture& picture, int x, int y, Colour colour);
void paste(Picture& target, const Picture& source, int x, int y);

/// Smooth (cubic) when enlarged, averaged when shrunk.
Image<float, 2> resized(const Image<float, 2>& image, int width, int height);

/// Points in pixels, pixel centres at whole numbers; what runs over the edge is cut off.
void draw_polyline(Picture& picture, std::span<const Point<2>> points, bool closed, Colour colour,
                   int width = 1);
void draw_cross(Picture& picture, const Point<2>& center, double radius, Colour colour, int width);
void draw_ring(Picture& picture, const Point<2>& center, double radius, Colour colour, int width);
/// ASCII text with its left end on the base line.
void draw_text(Picture& picture, int x, int baseline, const std::string& text, Colour colour = kInk,
               double scale = 0.5);
int text_width(const std::string& text, double scale = 0.5);

/// Blue over near-white to red for t = -1 .. 1.
Colour diverging(double t);
/// Dark blue over green to yellow for t = 0 .. 1, ever lighter: viridis.
Colour sequential(double t);

/// A vertical colour bar with ticks: position 0 (bottom) to 1 (top), and text.
struct Legend {
  std::function<Colour(double position)> colour;
  std::vector<std::pair<double, std::string>> ticks;
  std::vector<std::pair<Colour, std::string>> swatches;  ///< single colours below the bar
};

/// Panels side by side, each under its title, a legend at the right (no colour function: none), and
/// notes below.
Picture framed(const std::vector<std::pair<std::string, Picture>>& panels, const Legend& legend,
               const std::vector<std::string>& notes);

}  // namespace crease::canvas
