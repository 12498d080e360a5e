#include "Registration/Phantoms/MammogramFilm.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "Core/Parallel.h"
#include "Images/OpenCvView.h"

namespace crease {
namespace {

// In units of the frame, for a chest wall on the left.
struct Rectangle {
  double left, right, top, bottom, grey;
};
constexpr Rectangle kLabel[] = {{0.80, 0.94, 0.05, 0.09, 0.9}, {0.84, 0.94, 0.11, 0.14, 0.75}};

// How much of the pixel from `first` to `first` + 1 lies between the ends.
double overlap(double first, double lower, double upper) {
  return std::clamp(std::min(first + 1, upper) - std::max(first, lower), 0.0, 1.0);
}

// Draws into row j.
void draw(const Rectangle& rectangle, bool mirrored, int j, Image<double, 2>& image) {
  const auto [width, height] = image.size();
  const double rows = overlap(j, height * rectangle.top, height * rectangle.bottom);
  if (rows == 0) return;
  const int first = static_cast<int>(width * rectangle.left);
  const int last = static_cast<int>(width * rectangle.right);
  for (int i = first; i <= last; ++i) {
    const double covered = rows * overlap(i, width * rectangle.left, width * rectangle.right);
    double& grey = image(mirrored ? width - 1 - i : i, j);
    grey += covered * (rectangle.grey - grey);
  }
}

}  // namespace

Image<double, 2> exposed_film(const Raster<2>& raster, bool mirrored, bool label) {
  Image<double, 2> image(raster);
  for (int j = 0; j < raster.size[1]; ++j) {
    const auto row = image.row(j);
    std::fill(row.begin(), row.end(), 0.02 + 0.008 * j / raster.size[1]);
    if (!label) continue;
    for (const Rectangle& rectangle : kLabel) draw(rectangle, mirrored, j, image);
  }
  return image;
}

void blur_film(Image<double, 2>& image) {
  constexpr double kDeviation = 0.7;  // pixels
  constexpr int kWidth = 9;           // pixels: up to 5.7 deviations
  cv::Mat pixels = opencv_view(image);
  cv::GaussianBlur(pixels, pixels, {kWidth, kWidth}, kDeviation, kDeviation, cv::BORDER_REPLICATE);
}

FilmResponse draw_response(Random random) {
  FilmResponse response;
  response.gain = random.uniform(0.9, 1.1);
  response.gamma = random.uniform(0.9, 1.1);
  return response;
}

void apply_response(Image<double, 2>& image, const FilmResponse& response) {
  parallel_for(image.size()[1], [&](std::int64_t j) {
    for (double& grey : image.row(j)) {
      grey = response.gain * std::pow(std::max(grey, 0.0), response.gamma);
    }
  });
}

void add_film_noise(Image<double, 2>& image, double deviation, Random random) {
  if (deviation == 0) return;
  for (double& grey : image.values()) grey += deviation * random.normal();
}

Image<float, 2> digitised(const Image<double, 2>& image, int bits) {
  const double largest = (1 << bits) - 1;
  Image<float, 2> levels(image.raster());
  std::transform(image.values().begin(), image.values().end(), levels.values().begin(),
                 [&](double grey) {
                   return static_cast<float>(std::round(largest * std::clamp(grey, 0.0, 1.0)));
                 });
  return levels;
}

}  // namespace crease
