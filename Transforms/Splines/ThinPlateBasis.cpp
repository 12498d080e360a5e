#include "Transforms/Splines/ThinPlateBasis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/GaussRule.h"
#include "Transforms/LatticeGrid.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/CoveringCentres.h"

namespace crease {
namespace {

constexpr double kRing = 1e-6;  // in the frame: derivatives at a centre are those of this distance
constexpr double kAtCentre = 1e-14;  // in the frame: a point this near to a centre is the centre
constexpr double kCellRing = 0.1;    // likewise in quadrature, of a cell
constexpr int kPatchCells = 4;       // per axis
constexpr double kTableWork = 2e8;   // samples x n^2 up to which tables are made

/// r^2 log r or -r, and its derivatives.
template <int Dim>
struct Kernel {
  static double value(const Vector<Dim>& y) {
    const double r2 = y.squaredNorm();
    if constexpr (Dim == 2) return r2 > 0 ? 0.5 * r2 * std::log(r2) : 0.0;
    return -std::sqrt(r2);
  }
  /// U' / r, so that the gradient is that times y.
  static double slope(const Vector<Dim>& y) {
    const double r2 = std::max(y.squaredNorm(), kRing * kRing);
    if constexpr (Dim == 2) return std::log(r2) + 1;
    return -1 / std::sqrt(r2);
  }
  /// U_ab = slope I + bend y y^T; within a ring of the centre its mean over the ring.
  static Matrix<Dim> hessian(const Vector<Dim>& y, double ring = kRing) {
    const double r2 = std::max(y.squaredNorm(), ring * ring);
    const double mean = Dim == 2 ? std::log(r2) + 1 : -1 / std::sqrt(r2);
    const double bend = Dim == 2 ? 2 / r2 : std::pow(r2, -1.5);
    Matrix<Dim> square = y * y.transpose();
    if (y.squaredNorm() < r2) square = r2 / Dim * Matrix<Dim>::Identity();
    return mean * Matrix<Dim>::Identity() + bend * square;
  }
};

template <int Dim>
Eigen::MatrixXd kernel_matrix(const ControlPoints<Dim>& centres) {
  const Eigen::Index n = centres.cols();
  Eigen::MatrixXd K(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    for (Eigen::Index i = 0; i <= k; ++i) {
      K(i, k) = K(k, i) = Kernel<Dim>::value(centres.col(i) - centres.col(k));
    }
  }
  return K;
}

template <int Dim>
Eigen::MatrixXd affine_matrix(const ControlPoints<Dim>& centres) {
  Eigen::MatrixXd P(centres.cols(), Dim + 1);
  P << Eigen::VectorXd::Ones(centres.cols()), centres.transpose();
  return P;
}

/// w^T U(|y - y_i|) + a^T (1, y) for weights of several rows.
template <int Dim>
class ThinPlateSum final : public SplineSum<Dim> {
 public:
  ThinPlateSum(CentreFrame<Dim> frame, Eigen::MatrixXd weights, Eigen::MatrixXd affine)
      : frame_(std::move(frame)), weights_(std::move(weights)), affine_(std::move(affine)) {}

  Eigen::MatrixXd evaluate(const Point<Dim>& x, int derivatives) const override {
    constexpr int kSecond = kNumSecondDerivatives<Dim>;
    const Vector<Dim> y = frame_.local(x);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(
        weights_.rows(), 1 + (derivatives > 0 ? Dim : 0) + (derivatives > 1 ? kSecond : 0));
    sums.col(0) = affine_.col(0) + affine_.template rightCols<Dim>() * y;
    if (derivatives > 0) sums.template middleCols<Dim>(1) = affine_.template rightCols<Dim>();
    for (Eigen::Index i = 0; i < weights_.cols(); ++i) {
      const Vector<Dim> d = y - frame_.points.col(i);
      const auto w = weights_.col(i);
      sums.col(0) += Kernel<Dim>::value(d) * w;
      if (derivatives > 0) {
        sums.template middleCols<Dim>(1) += w * (Kernel<Dim>::slope(d) * d).transpose();
      }
      if (derivatives > 1) {
        const Matrix<Dim> second = Kernel<Dim>::hessian(d);
        for (int a = 0, s = 1 + Dim; a < Dim; ++a) {
          for (int b = a; b < Dim; ++b, ++s) sums.col(s) += second(a, b) * w;
        }
      }
    }
    if (derivatives > 0) sums.template middleCols<Dim>(1) /= frame_.length;
    if (derivatives > 1) sums.template rightCols<kSecond>() /= frame_.length * frame_.length;
    return sums;
  }

 private:
  CentreFrame<Dim> frame_;
  Eigen::MatrixXd weights_, affine_;  // rows x n, rows x (1 + Dim)
};

/// A regular grid of cells in whole patches over a box.
template <int Dim>
struct CellGrid {
  CellGrid(const Box<Dim>& box, double wanted) : lower(box.lower) {
    for (int a = 0; a < Dim; ++a) {
      const double cells = std::clamp(box.size()[a] / wanted, 1.0, 4096.0);
      patches[a] = std::max(1, static_cast<int>(std::lround(cells / kPatchCells)));
      cell[a] = box.size()[a] / (patches[a] * kPatchCells);
      num_patches *= patches[a];
    }
  }
  Point<Dim> lower;
  Vector<Dim> cell;
  std::array<int, Dim> patches;
  int num_patches = 1;
};

/// Points and weights of a product rule on all cells of a patch.
template <int Dim>
void patch_rule(const CellGrid<Dim>& grid, int patch, const GaussRule& rule,
                ControlPoints<Dim>& points, Eigen::VectorXd& weights) {
  const int per_axis = kPatchCells * static_cast<int>(rule.points.size());
  int count = 1;
  for (int a = 0; a < Dim; ++a) count *= per_axis;
  points.resize(Dim, count);
  weights.setConstant(count, grid.cell.prod());
  for (int q = 0; q < count; ++q) {
    for (int a = 0, rest = q, at = patch; a < Dim; rest /= per_axis, at /= grid.patches[a], ++a) {
      const int size = static_cast<int>(rule.points.size());
      const int cell = at % grid.patches[a] * kPatchCells + rest % per_axis / size;
      const auto k = static_cast<std::size_t>(rest % per_axis % size);
      points(a, q) = grid.lower[a] + (cell + rule.points[k]) * grid.cell[a];
      weights[q] *= rule.weights[k];
    }
  }
}

}  // namespace

template <int Dim>
ThinPlateBasis<Dim>::ThinPlateBasis(const ControlPoints<Dim>& centres, const Box<Dim>& bounds)
    : centres_(centres),
      bounds_(bounds),
      frame_("ThinPlateBasis", centres),
      system_(kernel_matrix<Dim>(frame_.points), affine_matrix<Dim>(frame_.points)) {
  if (bounds_.empty()) {
    for (Eigen::Index i = 0; i < centres_.cols(); ++i) bounds_.add(centres_.col(i));
  }
}

template <int Dim>
Eigen::MatrixXd ThinPlateBasis<Dim>::values(const ControlPoints<Dim>& points) const {
  constexpr int kTile = 64;
  const Eigen::Index n = centres_.cols(), count = points.cols();
  Eigen::MatrixXd result(n, count);
  parallel_for((count + kTile - 1) / kTile, [&](std::int64_t tile) {
    const Eigen::Index first = tile * kTile, size = std::min<Eigen::Index>(kTile, count - first);
    Eigen::MatrixXd kernel(n, size), affine(Dim + 1, size);
    for (Eigen::Index q = 0; q < size; ++q) {
      const Vector<Dim> y = frame_.local(points.col(first + q));
      for (Eigen::Index i = 0; i < n; ++i) {
        kernel(i, q) = Kernel<Dim>::value(y - frame_.points.col(i));
      }
      affine.col(q) << 1, y;
    }
    result.middleCols(first, size).noalias() = system_.E * kernel;
    result.middleCols(first, size).noalias() += system_.A.transpose() * affine;
  });
  return result;
}

template <int Dim>
int ThinPlateBasis<Dim>::centre_at(const Point<Dim>& x) const {
  Eigen::Index nearest = 0;
  const double distance =
      (frame_.points.colwise() - frame_.local(x)).colwise().squaredNorm().minCoeff(&nearest);
  return distance <= kAtCentre * kAtCentre ? static_cast<int>(nearest) : -1;
}

template <int Dim>
BasisValues<Dim> ThinPlateBasis<Dim>::evaluate(const Point<Dim>& x, int derivatives) const {
  if (!contains(x)) throw InvalidInput("ThinPlateBasis: the point is not finite.");
  const Eigen::Index n = centres_.cols();
  const int centre = centre_at(x);
  BasisValues<Dim> result;
  if (derivatives == 0 && centre >= 0) {
    result.control_points = {centre};
    result.values = Eigen::VectorXd::Ones(1);
    return result;
  }
  result.control_points.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) result.control_points[i] = i;
  const Vector<Dim> y = frame_.local(x);
  Eigen::VectorXd kernel(n);
  for (Eigen::Index i = 0; i < n; ++i) kernel[i] = Kernel<Dim>::value(y - frame_.points.col(i));
  Eigen::Matrix<double, Dim + 1, 1> affine;
  affine << 1, y;
  result.values = system_.E * kernel + system_.A.transpose() * affine;
  if (centre >= 0) result.values = Eigen::VectorXd::Unit(n, centre);
  if (derivatives == 0) return result;
  Eigen::MatrixXd slopes(n, Dim), bends(n, kNumSecondDerivatives<Dim>);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector<Dim> d = y - frame_.points.col(i);
    slopes.row(i) = (Kernel<Dim>::slope(d) * d).transpose();
    const Matrix<Dim> second = Kernel<Dim>::hessian(d);
    for (int a = 0, s = 0; a < Dim; ++a) {
      for (int b = a; b < Dim; ++b, ++s) bends(i, s) = second(a, b);
    }
  }
  result.gradients =
      (system_.E * slopes + system_.A.bottomRows(Dim).transpose()).transpose() / frame_.length;
  if (derivatives > 1) {
    result.hessians = (system_.E * bends).transpose() / (frame_.length * frame_.length);
  }
  return result;
}

template <int Dim>
std::unique_ptr<SplineSum<Dim>> ThinPlateBasis<Dim>::sum(
    const Eigen::Ref<const Eigen::MatrixXd>& control_points) const {
  return std::make_unique<ThinPlateSum<Dim>>(frame_, control_points * system_.E,
                                             control_points * system_.A.transpose());
}

/// The biharmonic operator of U is 8 pi times a point load; E measures lengths in the frame's.
template <int Dim>
double ThinPlateBasis<Dim>::bending_factor() const {
  return 8 * std::numbers::pi * std::pow(frame_.length, Dim - 4);
}

// With w = E f the minimum's condition is (f - y) / v + c w = 0: K w + P a = f = y - c v w.
template <int Dim>
Eigen::MatrixXd ThinPlateBasis<Dim>::smoothed(
    const Eigen::Ref<const Eigen::MatrixXd>& values,
    const Eigen::Ref<const Eigen::VectorXd>& variances) const {
  if (values.cols() != centres_.cols() || variances.size() != centres_.cols() ||
      !(variances.array() >= 0).all()) {
    throw InvalidInput(message("ThinPlateBasis: ", values.cols(), " values and ", variances.size(),
                               " variances to smooth; ", centres_.cols(),
                               " of both are needed, the variances 0 or more."));
  }
  const Eigen::VectorXd diagonal = bending_factor() * variances;
  Eigen::MatrixXd K = kernel_matrix<Dim>(frame_.points);
  K.diagonal() += diagonal;
  const CardinalSystem system(K, affine_matrix<Dim>(frame_.points));
  return values - values * system.E * diagonal.asDiagonal();
}

template <int Dim>
std::optional<Eigen::MatrixXd> ThinPlateBasis<Dim>::bending_matrix() const {
  return bending_factor() * system_.E;
}

template <int Dim>
std::vector<QuadratureElement<Dim>> ThinPlateBasis<Dim>::quadrature(
    int polynomial_degree, int derivatives,
    const std::function<bool(int region, int patch)>& wanted) const {
  const CellGrid<Dim> grid(bounds_, 0.5 * mean_edge_length());
  const GaussRule rule = gauss_rule(polynomial_degree / 2 + 1);
  const double ring = kCellRing * grid.cell.minCoeff() / frame_.length;
  std::vector<int> patches;
  for (int patch = 0; patch < grid.num_patches; ++patch) {
    if (!wanted || wanted(-1, patch)) patches.push_back(patch);
  }
  std::vector<QuadratureElement<Dim>> elements(patches.size());
  parallel_for(std::ssize(patches), [&](std::int64_t p) {
    auto& element = elements[static_cast<std::size_t>(p)];
    element.patch = patches[static_cast<std::size_t>(p)];
    ControlPoints<Dim> points;
    patch_rule<Dim>(grid, element.patch, rule, points, element.weights);
    element.points = points;
    const Eigen::Index n = centres_.cols(), count = points.cols();
    element.control_points.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) element.control_points[i] = i;
    Eigen::MatrixXd kernel(n, count), affine = Eigen::MatrixXd::Ones(Dim + 1, count);
    std::vector<Eigen::MatrixXd> slopes(derivatives > 0 ? Dim : 0, kernel);
    std::vector<Eigen::MatrixXd> bends(derivatives > 1 ? kNumSecondDerivatives<Dim> : 0, kernel);
    for (Eigen::Index q = 0; q < count; ++q) {
      const Vector<Dim> y = frame_.local(points.col(q));
      affine.col(q).template tail<Dim>() = y;
      for (Eigen::Index i = 0; i < n; ++i) {
        const Vector<Dim> d = y - frame_.points.col(i);
        kernel(i, q) = Kernel<Dim>::value(d);
        const double slope = derivatives > 0 ? Kernel<Dim>::slope(d) / frame_.length : 0;
        for (std::size_t a = 0; a < slopes.size(); ++a) slopes[a](i, q) = slope * d[a];
        if (derivatives < 2) continue;
        const Matrix<Dim> second = Kernel<Dim>::hessian(d, ring) / (frame_.length * frame_.length);
        for (int a = 0, s = 0; a < Dim; ++a) {
          for (int b = a; b < Dim; ++b, ++s) bends[s](i, q) = second(a, b);
        }
      }
    }
    element.values = system_.E * kernel + system_.A.transpose() * affine;
    for (std::size_t a = 0; a < slopes.size(); ++a) {
      element.gradients.push_back(system_.E * slopes[a]);
      element.gradients.back().colwise() +=
          system_.A.row(1 + static_cast<Eigen::Index>(a)).transpose() / frame_.length;
    }
    for (const auto& bend : bends) element.hessians.push_back(system_.E * bend);
  });
  return elements;
}

template <int Dim>
std::vector<std::pair<int, int>> ThinPlateBasis<Dim>::couplings() const {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < num_control_points(); ++i) {
    for (int k = i; k < num_control_points(); ++k) pairs.emplace_back(i, k);
  }
  return pairs;
}

template <int Dim>
std::unique_ptr<BoundGrid<Dim>> ThinPlateBasis<Dim>::bind(const Raster<Dim>& raster) const {
  const double n = num_control_points();
  if (static_cast<double>(raster.num_samples()) * n * n <= kTableWork) {
    return std::make_unique<SparseRowGrid<Dim>>(*this, raster);
  }
  constexpr double kSpansPerDistance = Dim == 2 ? 6 : 3;
  const double distance = mean_edge_length();
  const double pixel = raster.spacing.minCoeff();
  return std::make_unique<LatticeGrid<Dim>>(
      [this](const ControlPoints<Dim>& points) { return values(points); }, num_control_points(),
      raster, std::max(pixel, distance / kSpansPerDistance), 0.5 * distance);
}

template <int Dim>
std::shared_ptr<const ThinPlateBasis<Dim>> covering_thin_plate(
    const Raster<Dim>& raster, double length, std::span<const Point<Dim>> landmarks) {
  return std::make_shared<ThinPlateBasis<Dim>>(covering_centres<Dim>(raster, length, landmarks),
                                               raster.bounds());
}

template class ThinPlateBasis<2>;
template class ThinPlateBasis<3>;
template std::shared_ptr<const ThinPlateBasis<2>> covering_thin_plate(const Raster<2>&, double,
                                                                      std::span<const Point<2>>);
template std::shared_ptr<const ThinPlateBasis<3>> covering_thin_plate(const Raster<3>&, double,
                                                                      std::span<const Point<3>>);

}  // namespace crease
