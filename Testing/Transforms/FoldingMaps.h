#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <memory>
#include <vector>

#include "Testing/Transforms/SampleSplines.h"
#include "Transforms/SplineTransform.h"

namespace crease::testing {

/// Maps x + s u(x) with one random u and all s >= 0: the larger s, the more they fold.
template <int Dim>
class FoldingFamily {
 public:
  FoldingFamily(std::shared_ptr<const SplineBasis<Dim>> basis, unsigned seed)
      : basis_(std::move(basis)),
        phi_(Numbers(seed).columns<Dim>(basis_->num_control_points(), basis_->mean_edge_length())) {
    SplineTransform<Dim> u = transform(1);
    for (const auto& x : grid(Dim == 2 ? 120 : 24)) {
      if (!basis_->contains(x)) continue;
      gradients_.push_back(u.spatial_jacobian(x) - Matrix<Dim>::Identity());
      points_.push_back(x);
    }
  }

  /// The one whose least determinant over a very fine sampling, improved by a local search, is this.
  SplineTransform<Dim> scaled_to(double target) const {
    double low = 0, high = 1;
    while (least_at_samples(high).first > target) high *= 2;
    for (int step = 0; step < 60; ++step) {
      const double middle = 0.5 * (low + high);
      (least_at_samples(middle).first > target ? low : high) = middle;
    }
    // What lies between the samples: Newton's method for s with the least point held.
    double s = low;
    for (int step = 0; step < 3; ++step) {
      const Point<Dim> x = lowest_point(s);
      const Matrix<Dim> g = (transform(1).spatial_jacobian(x) - Matrix<Dim>::Identity());
      double a = 0, b = s;
      for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (a + b);
        ((Matrix<Dim>::Identity() + middle * g).determinant() > target ? a : b) = middle;
      }
      s = a;
    }
    return transform(s);
  }

  /// By sampling and a local search.
  double least_determinant(const SplineTransform<Dim>& map) const {
    const double s = map.control_points().norm() / phi_.norm();
    return std::min(map.spatial_jacobian(lowest_point(s)).determinant(), least_at_samples(s).first);
  }

  /// On a grid eight times finer than the mesh.
  double least_on_grid(const SplineTransform<Dim>& map) const {
    const double spans = basis_->bounds().size().maxCoeff() / basis_->mean_edge_length();
    double least = std::numeric_limits<double>::infinity();
    for (const auto& x : grid(static_cast<int>(8 * spans) + 1)) {
      if (basis_->contains(x)) least = std::min(least, map.spatial_jacobian(x).determinant());
    }
    return least;
  }

 private:
  SplineTransform<Dim> transform(double s) const {
    SplineTransform<Dim> result(basis_);
    result.set_control_points(s * phi_);
    return result;
  }

  std::vector<Point<Dim>> grid(int per_axis) const {
    const Box<Dim> box = basis_->bounds();
    std::vector<Point<Dim>> points;
    int count = 1;
    for (int a = 0; a < Dim; ++a) count *= per_axis;
    for (int n = 0; n < count; ++n) {
      Vector<Dim> t;
      for (int a = 0, rest = n; a < Dim; ++a, rest /= per_axis) {
        t[a] = (rest % per_axis + 0.5) / per_axis;
      }
      points.push_back(box.lower + t.cwiseProduct(box.size()));
    }
    return points;
  }

  std::pair<double, std::size_t> least_at_samples(double s) const {
    std::pair<double, std::size_t> least = {std::numeric_limits<double>::infinity(), 0};
    for (std::size_t n = 0; n < gradients_.size(); ++n) {
      const double det = (Matrix<Dim>::Identity() + s * gradients_[n]).determinant();
      if (det < least.first) least = {det, n};
    }
    return least;
  }

  /// Downhill from the lowest sample, along the axes, with steps that shrink.
  Point<Dim> lowest_point(double s) const {
    const SplineTransform<Dim> map = transform(s);
    Point<Dim> x = points_[least_at_samples(s).second];
    double least = map.spatial_jacobian(x).determinant();
    double step = 0.02 * basis_->mean_edge_length();
    while (step > 1e-5) {
      bool moved = false;
      for (int a = 0; a < 2 * Dim; ++a) {
        Point<Dim> y = x;
        y[a / 2] += a % 2 == 0 ? step : -step;
        if (!basis_->contains(y)) continue;
        const double det = map.spatial_jacobian(y).determinant();
        if (det >= least) continue;
        least = det;
        x = y;
        moved = true;
      }
      if (!moved) step *= 0.5;
    }
    return x;
  }

  std::shared_ptr<const SplineBasis<Dim>> basis_;
  ControlPoints<Dim> phi_;
  std::vector<Point<Dim>> points_;
  std::vector<Matrix<Dim>> gradients_;  // of u
};

template <int Dim>
FoldingFamily<Dim> folding_family(std::shared_ptr<const SplineBasis<Dim>> basis, unsigned seed) {
  return FoldingFamily<Dim>(std::move(basis), seed);
}

}  // namespace crease::testing
