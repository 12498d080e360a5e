#include "Testing/Experiments/Experiment.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>

#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/StructuredTriangulation.h"
#include "Transforms/LandmarkFits.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease::experiments {
namespace {

/// Calls visit(x) for the pixel centres of a body.
template <typename Visit>
void for_each_pixel(const Phantom& phantom, int label, Visit&& visit) {
  const auto& raster = phantom.labels.raster();
  for (int j = 0; j < raster.size[1]; ++j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      if (phantom.labels(i, j) == label) {
        visit(raster.point({static_cast<double>(i), static_cast<double>(j)}));
      }
    }
  }
}

Matrix<2> rotation(double angle_deg) {
  return Eigen::Rotation2Dd(angle_deg * std::numbers::pi / 180).toRotationMatrix();
}

}  // namespace

BodyError body_error(const Transform<2>& transform, const Phantom& phantom,
                     const PhantomBody& body) {
  BodyError error;
  std::vector<Point<2>> from, to;
  const Matrix<2> R = rotation(body.angle_deg);
  for_each_pixel(phantom, body.label, [&](const Point<2>& x) {
    from.push_back(x);
    to.push_back(transform.map(x));
    error.rms_mm += (to.back() - phantom.truth(x)).squaredNorm();
    error.rms_gradient += (transform.spatial_jacobian(x) - R).squaredNorm();
  });
  const auto count = static_cast<double>(from.size());
  error.rms_mm = std::sqrt(error.rms_mm / count);
  error.rms_gradient = std::sqrt(error.rms_gradient / count);
  const AffineMap<2> fit = fit_rigid<2>(from, to).affine_map();
  const Matrix<2> left_over = fit.linear * R.transpose();
  error.angle_error_deg =
      std::abs(std::atan2(left_over(1, 0), left_over(0, 0))) * 180 / std::numbers::pi;
  error.shift_error_mm = (fit(body.center) - body.center - body.shift_mm).norm();
  return error;
}

JacobianRange jacobian_range(const Transform<2>& transform, const Raster<2>& raster) {
  JacobianRange range{HUGE_VAL, -HUGE_VAL};
  for (int j = 0; j < raster.size[1]; ++j) {
    for (int i = 0; i < raster.size[0]; ++i) {
      const Point<2> x = raster.point({static_cast<double>(i), static_cast<double>(j)});
      const double det = transform.spatial_jacobian(x).determinant();
      range.min = std::min(range.min, det);
      range.max = std::max(range.max, det);
    }
  }
  return range;
}

std::shared_ptr<const SplineBasis<2>> structured_basis(const Phantom& phantom, int cells,
                                                       bool creases) {
  const auto mesh = structured_triangulation(phantom.fixed.raster().bounds(), cells, cells);
  auto outlines = phantom.feature_lines;
  for (auto& line : outlines) line.corner = CornerRule::kCollapse;  // the bodies' corners are sharp
  const DomainMesh domain = attach_feature_lines(mesh, outlines);
  const PlacedKnots knots = place_knots(domain, {.creases = creases, .structured = true});
  return std::make_shared<TriangularBSplineBasis<2>>(knots.net);
}

int finish(const Json& figures, const std::vector<Threshold>& thresholds) {
  std::cout << figures.dump() << std::endl;
  int missed = 0;
  for (const auto& t : thresholds) {
    const bool met = t.at_least ? t.value >= t.bound : t.value <= t.bound;
    if (met) continue;
    ++missed;
    std::fprintf(stderr, "missed: %s is %g, wanted %s %g\n", t.what.c_str(), t.value,
                 t.at_least ? "at least" : "at most", t.bound);
  }
  return missed == 0 ? 0 : 1;
}

int give_up(const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}

std::filesystem::path output_folder(int argc, char** argv, const std::string& fallback) {
  std::filesystem::path folder = argc > 1 ? argv[1] : fallback;
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace crease::experiments
