#include "Transforms/Splines/TensorBSplineBasis.h"

#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/GaussRule.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/TensorBSplineGrid.h"
#include "Transforms/Splines/TensorBSplinePieces.h"
#include "Transforms/Splines/TensorIndex.h"

namespace crease {
namespace {

constexpr double kTolerance = 1e-9;  // of a span

constexpr double kMostSpans = 2e6;

template <int Dim>
const TensorLattice<Dim>& checked(const TensorLattice<Dim>& lattice, int degree) {
  if (degree < 1 || degree > kMaxTensorDegree) {
    throw InvalidInput(message("TensorBSplineBasis: the degree is ", degree, "; it must be 1 to ",
                               kMaxTensorDegree, "."));
  }
  for (int a = 0; a < Dim; ++a) {
    if (lattice.spans[a] < 1) {
      throw InvalidInput(message("TensorBSplineBasis: axis ", a, " has ", lattice.spans[a],
                                 " knot spans; at least 1 is needed."));
    }
    if (!(lattice.spacing[a] > 0) || !std::isfinite(lattice.spacing[a])) {
      throw InvalidInput(message("TensorBSplineBasis: the spacing of axis ", a, " is ",
                                 lattice.spacing[a], " mm; it must be positive."));
    }
  }
  const auto& d = lattice.direction;
  if (!lattice.origin.allFinite() || !d.allFinite() ||
      !(d.transpose() * d).isApprox(Matrix<Dim>::Identity(), 1e-6)) {
    throw InvalidInput(
        "TensorBSplineBasis: the origin must be finite and the direction orthonormal.");
  }
  return lattice;
}

/// The element of the span at the lattice's origin; all others are its translations.
template <int Dim>
QuadratureElement<Dim> first_element(const TensorLattice<Dim>& lattice, int degree,
                                     int polynomial_degree, int derivatives) {
  const GaussRule rule = gauss_rule(polynomial_degree / 2 + 1);
  std::array<int, Dim> rule_size;
  rule_size.fill(static_cast<int>(rule.points.size()));
  const int num_points = product<Dim>(rule_size);
  const TensorBSplineFunctions<Dim> functions(lattice, degree);
  const int k = functions.count();

  QuadratureElement<Dim> element;
  element.points.resize(Dim, num_points);
  element.weights.resize(num_points);
  element.values.resize(k, num_points);
  if (derivatives > 0) element.gradients.assign(Dim, Eigen::MatrixXd(k, num_points));
  if (derivatives > 1) {
    element.hessians.assign(kNumSecondDerivatives<Dim>, Eigen::MatrixXd(k, num_points));
  }
  BasisValues<Dim> at_point;
  for (int q = 0; q < num_points; ++q) {
    const auto index = unravel<Dim>(q, rule_size);
    Vector<Dim> local;
    double weight = lattice.spacing.prod();
    for (int a = 0; a < Dim; ++a) {
      local[a] = rule.points[index[a]];
      weight *= rule.weights[index[a]];
    }
    element.points.col(q) = lattice.point(local);
    element.weights[q] = weight;
    functions.evaluate(local, derivatives, at_point);
    element.values.col(q) = at_point.values;
    for (std::size_t a = 0; a < element.gradients.size(); ++a) {
      element.gradients[a].col(q) = at_point.gradients.row(a);
    }
    for (std::size_t s = 0; s < element.hessians.size(); ++s) {
      element.hessians[s].col(q) = at_point.hessians.row(s);
    }
  }
  return element;
}

}  // namespace

template <int Dim>
TensorLattice<Dim> covering_lattice(const Raster<Dim>& raster, double span_size_mm) {
  if (raster.num_samples() == 0 || !(span_size_mm > 0) || !std::isfinite(span_size_mm)) {
    throw InvalidInput(message("covering_lattice: a span of ", span_size_mm, " mm on a raster of ",
                               raster.num_samples(), " samples; both must be positive."));
  }
  TensorLattice<Dim> lattice;
  lattice.origin = raster.point(Vector<Dim>::Constant(-0.5));
  lattice.direction = raster.direction;
  const double count = static_cast<double>(raster.num_samples()) * raster.sample_volume() /
                       std::pow(span_size_mm, Dim);
  if (count > kMostSpans) {
    throw InvalidInput(message("covering_lattice: knot spans of ", span_size_mm,
                               " mm would be about ", count, "; at most ", kMostSpans,
                               " are possible: choose larger spans."));
  }
  for (int a = 0; a < Dim; ++a) {
    const double extent = raster.size[a] * raster.spacing[a];
    lattice.spans[a] = std::max(1, static_cast<int>(std::lround(extent / span_size_mm)));
    lattice.spacing[a] = extent / lattice.spans[a];
  }
  return lattice;
}

template <int Dim>
TensorBSplineBasis<Dim>::TensorBSplineBasis(const TensorLattice<Dim>& lattice, int degree)
    : lattice_(checked(lattice, degree)), degree_(degree), functions_(lattice, degree) {}

template <int Dim>
std::array<int, Dim> TensorBSplineBasis<Dim>::net_size() const {
  auto size = lattice_.spans;
  for (int& s : size) s += degree_;
  return size;
}

template <int Dim>
Raster<Dim> TensorBSplineBasis<Dim>::control_raster() const {
  Raster<Dim> raster;
  raster.size = net_size();
  raster.spacing = lattice_.spacing;
  raster.direction = lattice_.direction;
  raster.origin = lattice_.point(Vector<Dim>::Constant(-0.5 * (degree_ - 1)));
  return raster;
}

template <int Dim>
TensorBSplineBasis<Dim> TensorBSplineBasis<Dim>::refined() const {
  auto finer = lattice_;
  for (int& s : finer.spans) s *= 2;
  finer.spacing /= 2;
  return TensorBSplineBasis(finer, degree_);
}

// B(t) = 2^-p sum_k binomial(p + 1, k) B(2 t - k), axis by axis.
template <int Dim>
Eigen::MatrixXd TensorBSplineBasis<Dim>::refine_control_points(
    const Eigen::Ref<const Eigen::MatrixXd>& control_points) const {
  if (control_points.cols() != num_control_points()) {
    throw InvalidInput(message("TensorBSplineBasis: ", control_points.cols(),
                               " control points given, ", num_control_points(), " expected."));
  }
  const int p = degree_;
  std::array<double, kMaxTensorDegree + 2> weight{};
  weight[0] = std::ldexp(1.0, -p);
  for (int k = 1; k <= p + 1; ++k) weight[k] = weight[k - 1] * (p + 2 - k) / k;

  Eigen::MatrixXd points = control_points;
  auto size = net_size();
  for (int a = 0; a < Dim; ++a) {
    auto finer_size = size;
    finer_size[a] = 2 * lattice_.spans[a] + p;
    Eigen::MatrixXd finer(points.rows(), product<Dim>(finer_size));
    for (int n = 0; n < finer.cols(); ++n) {
      auto index = unravel<Dim>(n, finer_size);
      const int j = index[a];
      finer.col(n).setZero();
      for (int i = std::max(0, (j - 1) / 2); i < size[a] && j - 2 * i + p >= 0; ++i) {
        const int k = j - 2 * i + p;
        if (k > p + 1) continue;
        index[a] = i;
        finer.col(n) += weight[k] * points.col(ravel<Dim>(index, size));
      }
    }
    points = std::move(finer);
    size = finer_size;
  }
  return points;
}

template <int Dim>
int TensorBSplineBasis<Dim>::num_control_points() const {
  return product<Dim>(net_size());
}

template <int Dim>
bool TensorBSplineBasis<Dim>::contains(const Point<Dim>& x) const {
  const Vector<Dim> t = lattice_.coordinates(x);
  for (int a = 0; a < Dim; ++a) {
    if (!(t[a] >= -kTolerance && t[a] <= lattice_.spans[a] + kTolerance)) return false;
  }
  return true;
}

template <int Dim>
Point<Dim> TensorBSplineBasis<Dim>::nearest_point(const Point<Dim>& x) const {
  if (contains(x)) return x;
  Vector<Dim> t = lattice_.coordinates(x);
  for (int a = 0; a < Dim; ++a) t[a] = std::clamp(t[a], 0.0, double(lattice_.spans[a]));
  return lattice_.point(t);
}

template <int Dim>
Box<Dim> TensorBSplineBasis<Dim>::bounds() const {
  Box<Dim> box;
  for (int corner = 0; corner < (1 << Dim); ++corner) {
    Vector<Dim> t;
    for (int a = 0; a < Dim; ++a) t[a] = (corner >> a & 1) ? lattice_.spans[a] : 0;
    box.add(lattice_.point(t));
  }
  return box;
}

template <int Dim>
double TensorBSplineBasis<Dim>::measure() const {
  return lattice_.spacing.prod() * product<Dim>(lattice_.spans);
}

template <int Dim>
typename TensorBSplineBasis<Dim>::Cell TensorBSplineBasis<Dim>::locate(const Point<Dim>& x) const {
  const Vector<Dim> t = lattice_.coordinates(x);
  Cell cell;
  for (int a = 0; a < Dim; ++a) {
    if (!(t[a] >= -kTolerance && t[a] <= lattice_.spans[a] + kTolerance)) {
      throw InvalidInput(message("TensorBSplineBasis: the point (", x.transpose(),
                                 ") mm lies outside the domain, whose axis ", a, " ends after ",
                                 lattice_.spans[a] * lattice_.spacing[a], " mm."));
    }
    cell.span[a] = std::clamp(static_cast<int>(t[a]), 0, lattice_.spans[a] - 1);
    cell.local[a] = std::clamp(t[a] - cell.span[a], 0.0, 1.0);
  }
  return cell;
}

template <int Dim>
void TensorBSplineBasis<Dim>::fill_control_points(const std::array<int, Dim>& span,
                                                  std::vector<int>& numbers) const {
  const auto size = net_size();
  const int corner = ravel<Dim>(span, size);
  numbers.resize(static_cast<std::size_t>(functions_.count()));
  auto* number = numbers.data();
  for (int k = 0; k <= (Dim == 3 ? degree_ : 0); ++k) {
    for (int j = 0; j <= degree_; ++j) {
      const int row = corner + size[0] * (j + size[1] * k);
      for (int i = 0; i <= degree_; ++i) *number++ = row + i;
    }
  }
}

template <int Dim>
BasisValues<Dim> TensorBSplineBasis<Dim>::evaluate(const Point<Dim>& x, int derivatives) const {
  const Cell cell = locate(x);
  BasisValues<Dim> result;
  fill_control_points(cell.span, result.control_points);
  functions_.evaluate(cell.local, derivatives, result);
  return result;
}

template <int Dim>
ControlPoints<Dim> TensorBSplineBasis<Dim>::greville_points() const {
  const Raster<Dim> raster = control_raster();
  ControlPoints<Dim> points(Dim, num_control_points());
  for (int n = 0; n < points.cols(); ++n) {
    const auto index = unravel<Dim>(n, raster.size);
    Vector<Dim> position;
    for (int a = 0; a < Dim; ++a) position[a] = index[a];
    points.col(n) = raster.point(position);
  }
  return points;
}

template <int Dim>
std::vector<QuadratureElement<Dim>> TensorBSplineBasis<Dim>::quadrature(
    int polynomial_degree, int derivatives,
    const std::function<bool(int region, int patch)>& wanted) const {
  std::vector<int> patches;
  for (int patch = 0; patch < product<Dim>(lattice_.spans); ++patch) {
    if (!wanted || wanted(-1, patch)) patches.push_back(patch);
  }
  if (patches.empty()) return {};
  const auto first = first_element<Dim>(lattice_, degree_, polynomial_degree, derivatives);
  std::vector<QuadratureElement<Dim>> elements(patches.size());
  parallel_for(std::ssize(patches), [&](std::int64_t n) {
    auto& element = elements[static_cast<std::size_t>(n)];
    element = first;
    element.patch = patches[static_cast<std::size_t>(n)];
    const auto span = unravel<Dim>(element.patch, lattice_.spans);
    Vector<Dim> t;
    for (int a = 0; a < Dim; ++a) t[a] = span[a];
    element.points.colwise() += lattice_.point(t) - lattice_.origin;
    fill_control_points(span, element.control_points);
  });
  return elements;
}

template <int Dim>
std::vector<std::pair<int, int>> TensorBSplineBasis<Dim>::couplings() const {
  const auto size = net_size();
  std::vector<std::pair<int, int>> pairs;
  std::array<int, Dim> reach;
  reach.fill(2 * degree_ + 1);
  for (int i = 0; i < num_control_points(); ++i) {
    const auto at = unravel<Dim>(i, size);
    for (int n = 0; n < product<Dim>(reach); ++n) {
      auto other = unravel<Dim>(n, reach);
      bool inside = true;
      for (int a = 0; a < Dim; ++a) {
        other[a] += at[a] - degree_;
        inside = inside && other[a] >= 0 && other[a] < size[a];
      }
      if (!inside) continue;
      const int k = ravel<Dim>(other, size);
      if (i <= k) pairs.emplace_back(i, k);
    }
  }
  return pairs;
}

template <int Dim>
std::unique_ptr<DeterminantPieces<Dim>> TensorBSplineBasis<Dim>::determinant_pieces(
    const ControlPoints<Dim>& phi, const Matrix<Dim>& linear) const {
  return std::make_unique<TensorBSplinePieces<Dim>>(lattice_, degree_, phi, linear);
}

template <int Dim>
std::unique_ptr<BoundGrid<Dim>> TensorBSplineBasis<Dim>::bind(const Raster<Dim>& raster) const {
  if (TensorBSplineGrid<Dim>::can_bind(lattice_, raster)) {
    return std::make_unique<TensorBSplineGrid<Dim>>(lattice_, degree_, raster);
  }
  return std::make_unique<SparseRowGrid<Dim>>(*this, raster);
}

template class TensorBSplineBasis<2>;
template class TensorBSplineBasis<3>;
template TensorLattice<2> covering_lattice(const Raster<2>&, double);
template TensorLattice<3> covering_lattice(const Raster<3>&, double);

}  // namespace crease
