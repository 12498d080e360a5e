#include "Registration/PicturesCanvas.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "Images/OpenCvView.h"

namespace crease::canvas {
namespace {

constexpr int kMargin = 16, kTitleHeight = 30, kNoteHeight = 22, kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kBarWidth = 22, kBarTicks = 8;
constexpr int kShift = 4;  // OpenCV's fixed-point coordinates: 1/16 pixel

cv::Mat view(Picture& picture) {
  return cv::Mat(picture.height, picture.width, CV_8UC3, picture.rgb.data());
}

cv::Scalar scalar(Colour c) { return {double(c.red), double(c.green), double(c.blue)}; }

cv::Point fixed_point(const Point<2>& p) {
  constexpr double kFarthest = 1e6;  // far outside any picture, within range of an int
  return {static_cast<int>(std::lround(std::clamp(p.x(), -kFarthest, kFarthest) * (1 << kShift))),
          static_cast<int>(std::lround(std::clamp(p.y(), -kFarthest, kFarthest) * (1 << kShift)))};
}

int legend_width(const Legend& legend) {
  int width = 0;
  for (const auto& [position, text] : legend.ticks) {
    width = std::max(width, kBarWidth + kBarTicks + 4 + text_width(text));
  }
  for (const auto& [colour, text] : legend.swatches) {
    width = std::max(width, kBarWidth + kBarTicks + 4 + text_width(text));
  }
  return width == 0 ? 0 : width + kMargin;
}

void draw_bar(Picture& picture, const Legend& legend, int x, int top, int bottom) {
  for (int y = top; y <= bottom; ++y) {
    const Colour colour = legend.colour(double(bottom - y) / (bottom - top));
    for (int i = 0; i < kBarWidth; ++i) set_pixel(picture, x + i, y, colour);
  }
  const std::vector<Point<2>> frame = {
      {x - 1, top - 1}, {x + kBarWidth, top - 1}, {x + kBarWidth, bottom + 1}, {x - 1, bottom + 1}};
  draw_polyline(picture, frame, true, kInk);
  for (const auto& [position, text] : legend.ticks) {
    const int y = static_cast<int>(std::lround(bottom - position * (bottom - top)));
    const std::vector<Point<2>> tick = {{x + kBarWidth, y}, {x + kBarWidth + kBarTicks - 3, y}};
    draw_polyline(picture, tick, false, kInk);
    draw_text(picture, x + kBarWidth + kBarTicks, y + 5, text);
  }
}

void draw_legend(Picture& picture, const Legend& legend, int x, int top, int bottom) {
  const int swatches = static_cast<int>(legend.swatches.size());
  int bar_bottom = bottom - 8 - swatches * (kNoteHeight + 6);
  if (legend.colour) draw_bar(picture, legend, x, top + 8, bar_bottom);
  for (const auto& [colour, text] : legend.swatches) {
    bar_bottom += kNoteHeight + 6;
    for (int j = 0; j < kBarWidth; ++j) {
      for (int i = 0; i < kBarWidth; ++i) {
        const bool rim = i == 0 || j == 0 || i == kBarWidth - 1 || j == kBarWidth - 1;
        set_pixel(picture, x + i, bar_bottom - 14 + j, rim ? kInk : colour);
      }
    }
    draw_text(picture, x + kBarWidth + kBarTicks, bar_bottom + 2, text);
  }
}

using Stops = std::array<std::array<double, 3>, 9>;

/// The colour at 0 .. 1 between stops at equal distances.
Colour between(const Stops& stops, double position) {
  const double x = 8 * std::clamp(position, 0.0, 1.0);
  const auto k = std::min<std::size_t>(static_cast<std::size_t>(x), 7);
  const double share = x - static_cast<double>(k);
  std::array<std::uint8_t, 3> c;
  for (std::size_t i = 0; i < 3; ++i) {
    c[i] = static_cast<std::uint8_t>(
        std::lround(stops[k][i] + share * (stops[k + 1][i] - stops[k][i])));
  }
  return {c[0], c[1], c[2]};
}

}  // namespace

Picture blank(int width, int height, Colour colour) {
  Picture picture{width, height, std::vector<std::uint8_t>(std::size_t(width) * height * 3)};
  view(picture).setTo(scalar(colour));
  return picture;
}

void set_pixel(Picture& picture, int x, int y, Colour colour) {
  std::uint8_t* const p = &picture.rgb[(std::size_t(y) * picture.width + x) * 3];
  p[0] = colour.red;
  p[1] = colour.green;
  p[2] = colour.blue;
}

void paste(Picture& target, const Picture& source, int x, int y) {
  for (int j = 0; j < source.height; ++j) {
    const auto from = source.rgb.begin() + std::ptrdiff_t(j) * source.width * 3;
    std::copy(from, from + source.width * 3,
              target.rgb.begin() + ((std::ptrdiff_t(y) + j) * target.width + x) * 3);
  }
}

Image<float, 2> resized(const Image<float, 2>& image, int width, int height) {
  Raster<2> raster;
  raster.size = {width, height};
  Image<float, 2> result(raster);
  cv::Mat out = opencv_view(result);
  const bool smaller = width < image.size()[0];
  cv::resize(opencv_view(image), out, out.size(), 0, 0, smaller ? cv::INTER_AREA : cv::INTER_CUBIC);
  return result;
}

void draw_polyline(Picture& picture, std::span<const Point<2>> points, bool closed, Colour colour,
                   int width) {
  std::vector<cv::Point> corners;
  corners.reserve(points.size());
  for (const auto& p : points) corners.push_back(fixed_point(p));
  cv::polylines(view(picture), corners, closed, scalar(colour), width, cv::LINE_AA, kShift);
}

void draw_cross(Picture& picture, const Point<2>& center, double radius, Colour colour, int width) {
  for (const Vector<2>& arm : {Vector<2>(radius, radius), Vector<2>(radius, -radius)}) {
    const std::array<Point<2>, 2> line = {center - arm, center + arm};
    draw_polyline(picture, line, false, colour, width);
  }
}

void draw_ring(Picture& picture, const Point<2>& center, double radius, Colour colour, int width) {
  cv::circle(view(picture), fixed_point(center), static_cast<int>(radius * (1 << kShift)),
             scalar(colour), width, cv::LINE_AA, kShift);
}

void draw_text(Picture& picture, int x, int baseline, const std::string& text, Colour colour,
               double scale) {
  cv::putText(view(picture), text, {x, baseline}, kFont, scale, scalar(colour), 1, cv::LINE_AA);
}

int text_width(const std::string& text, double scale) {
  return cv::getTextSize(text, kFont, scale, 1, nullptr).width;
}

Colour diverging(double t) {
  // ColorBrewer's RdBu from blue to red
  constexpr Stops kStops = {{{5, 48, 97},
                             {33, 102, 172},
                             {67, 147, 195},
                             {146, 197, 222},
                             {247, 247, 247},
                             {244, 165, 130},
                             {214, 96, 77},
                             {178, 24, 43},
                             {103, 0, 31}}};
  return between(kStops, 0.5 * (t + 1));
}

Colour sequential(double t) {
  // matplotlib's viridis
  constexpr Stops kStops = {{{68, 1, 84},
                             {71, 45, 123},
                             {59, 82, 139},
                             {44, 114, 142},
                             {33, 145, 140},
                             {40, 174, 128},
                             {94, 201, 98},
                             {173, 220, 48},
                             {253, 231, 37}}};
  return between(kStops, t);
}

Picture framed(const std::vector<std::pair<std::string, Picture>>& panels, const Legend& legend,
               const std::vector<std::string>& notes) {
  int width = kMargin, panel_height = 0, notes_width = 0;
  for (const auto& [title, panel] : panels) {
    width += std::max(panel.width, text_width(title, 0.6)) + kMargin;
    panel_height = std::max(panel_height, panel.height);
  }
  const int legend_x = width + 2;
  for (const auto& note : notes) notes_width = std::max(notes_width, text_width(note));
  width = std::max(width + legend_width(legend), notes_width + 2 * kMargin);
  const int panel_bottom = kTitleHeight + panel_height;
  const int notes_height = static_cast<int>(notes.size()) * kNoteHeight;
  Picture picture = blank(width, panel_bottom + kMargin + notes_height, kPaper);
  int x = kMargin;
  for (const auto& [title, panel] : panels) {
    draw_text(picture, x, kTitleHeight - 10, title, kInk, 0.6);
    paste(picture, panel, x, kTitleHeight);
    x += std::max(panel.width, text_width(title, 0.6)) + kMargin;
  }
  draw_legend(picture, legend, legend_x, kTitleHeight, panel_bottom);
  for (std::size_t i = 0; i < notes.size(); ++i) {
    const int below = static_cast<int>(i + 1) * kNoteHeight;
    draw_text(picture, kMargin, panel_bottom + below, notes[i]);
  }
  return picture;
}

}  // namespace crease::canvas
