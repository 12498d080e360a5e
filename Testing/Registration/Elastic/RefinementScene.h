#pragma once

#include <cmath>
#include <numbers>

#include "Registration/Elastic/ImageRefinement.h"
#include "Testing/Registration/TestScenes.h"
#include "Testing/Transforms/SampleBases.h"
#include "Testing/Transforms/SampleSplines.h"

namespace crease::testing {

/// An image pair whose true map is x -> y + u*(y), y = x + v(x), with u* known and v to be found: the body is
/// a square within the image, held at the two corners of its left side.
struct RefinementScene {
  explicit RefinementScene(int size = 96) : raster(raster_of<2>(size)) {
    box.add(Point<2>::Constant(0.09 * size));
    box.add(Point<2>::Constant(0.91 * size));
    basis = triangles_over(box, {.degree = 2}, 5);
    start = std::make_shared<SplineTransform<2>>(basis);
    start->set_control_points(Numbers(5).columns<2>(basis->num_control_points(), 0.015 * size));
    moving = scene_image<2>(raster);
    fixed = image_of<2>(raster, [this](const Point<2>& x) { return truth(x); });
    options.pins = {box.lower, {box.lower[0], box.upper[1]}};
    options.levels = 2;
    options.material.tissue = {1000, 0.4};
    options.relative_weight = 2;
    options.smoothing_mm = {1, 0};
  }
  Point<2> moved(const Point<2>& x) const {
    const Vector<2> share = (x - box.lower).cwiseQuotient(box.size());
    const double pi = std::numbers::pi;
    return x + 0.015 * raster.size[0] * share[0] *
                   Vector<2>(std::cos(pi * share[1]), std::sin(pi * share[0] + share[1]));
  }
  Point<2> truth(const Point<2>& x) const { return start->map(moved(x)); }
  ImageRefinementResult refine() const {
    return refine_by_images(fixed, moving, nullptr, *start, options);
  }
  /// Root mean square of the distance from the truth over points of the body, pixels.
  double error(const Transform<2>& refinement) const {
    double sum = 0;
    constexpr int kPoints = 40;
    for (int j = 0; j < kPoints; ++j) {
      for (int i = 0; i < kPoints; ++i) {
        const Point<2> x =
            box.lower + box.size().cwiseProduct(Vector<2>(i + 0.5, j + 0.5)) / kPoints;
        sum += (start->map(refinement.map(x)) - truth(x)).squaredNorm();
      }
    }
    return std::sqrt(sum) / kPoints;
  }

  Raster<2> raster;
  Box<2> box;
  std::shared_ptr<const SplineBasis<2>> basis;
  std::shared_ptr<SplineTransform<2>> start;
  Image<float, 2> fixed, moving;
  ImageRefinementOptions options;
};

}  // namespace crease::testing
