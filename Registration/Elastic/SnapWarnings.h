#pragma once

#include <string>
#include <utility>
#include <vector>

namespace crease {

/// What is said of points that were moved onto a border: of each that lay clearly outside, and of all others, which
/// lay no farther than a border found in an image may be off, together.
class SnapWarnings {
 public:
  /// @param points  "moving points"; @param body  "the moving image's body"
  SnapWarnings(std::string points, std::string body)
      : points_(std::move(points)), body_(std::move(body)) {}

  /// @param point  "pair 3: the moving point (1, 2) mm"
  void add(const std::string& point, double distance_mm);
  std::vector<std::string> list() const;

 private:
  std::string points_, body_;
  std::vector<std::string> clearly_outside_;
  int hardly_outside_ = 0;
  double farthest_ = 0;  // of the latter
};

}  // namespace crease
