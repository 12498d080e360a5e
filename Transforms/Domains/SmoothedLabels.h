#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace crease {

/// The indicators of all bodies of a label image, each smoothed by a Gaussian and shifted so that the half
/// level keeps the body's area. The image is continued by its border pixels, and all bodies end at the
/// rim of the continued image, so that every border between labels is closed.
class SmoothedLabels {
 public:
  static constexpr int kPad = 20;  ///< nodes beyond the image on every side

  /// @param sigma  pixels, positive.
  SmoothedLabels(int width, int height, std::span<const std::int32_t> labels, double sigma);

  int width() const { return width_ + 2 * kPad; }
  int height() const { return height_ + 2 * kPad; }
  /// The label with the largest share per node, i fastest; node (i, j) is pixel (i - kPad, j - kPad).
  const std::vector<int>& labels() const { return best_; }
  double share(int label, int node) const;
  std::vector<int> bodies() const;  ///< labels above 0, ascending

 private:
  struct Window {
    int left = 0, bottom = 0, width = 0, height = 0;  // in nodes
    double shift = 0;                                 // added to the values
    std::vector<float> values;
    double at(int i, int j) const {
      i -= left;
      j -= bottom;
      if (i < 0 || j < 0 || i >= width || j >= height) return 0;
      return values[static_cast<std::size_t>(j) * width + i];
    }
  };

  Window smoothed(std::span<const std::int32_t> labels, int label, const Window& extent,
                  const std::vector<float>& kernel) const;
  void clear_rim();
  double area_keeping_level(const Window& window, double num_pixels) const;

  int width_, height_;
  std::map<int, Window> windows_;
  std::vector<float> background_;
  std::vector<int> best_;
};

/// Gives soft pixels between two bodies to the nearer one where the gap is at most `gap_mm` wide; dx, dy
/// are mm per pixel. Returns the number of pixels changed.
int close_narrow_gaps(int width, int height, std::vector<std::int32_t>& labels, double gap_mm,
                      double dx, double dy);

}  // namespace crease
