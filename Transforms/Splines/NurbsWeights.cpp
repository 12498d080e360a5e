#include "Transforms/Splines/NurbsWeights.h"

#include <Eigen/SparseLU>
#include <cmath>

#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/TensorIndex.h"

namespace crease {
namespace {

/// A net's lines along one axis as columns: net.rows() columns for every line.
template <int Dim>
Eigen::MatrixXd lines_of(const Eigen::Ref<const Eigen::MatrixXd>& net,
                         const std::array<int, Dim>& size, int axis) {
  Eigen::MatrixXd lines(size[axis], net.size() / size[axis]);
  auto across = size;
  across[axis] = 1;
  for (int line = 0; line < product<Dim>(across); ++line) {
    auto index = unravel<Dim>(line, across);
    for (index[axis] = 0; index[axis] < size[axis]; ++index[axis]) {
      lines.row(index[axis]).segment(line * net.rows(), net.rows()) =
          net.col(ravel<Dim>(index, size)).transpose();
    }
  }
  return lines;
}

/// The net of such lines; `size` is the net's, along the axis that of the lines.
template <int Dim>
Eigen::MatrixXd net_of(const Eigen::MatrixXd& lines, Eigen::Index rows,
                       const std::array<int, Dim>& size, int axis) {
  Eigen::MatrixXd net(rows, product<Dim>(size));
  auto across = size;
  across[axis] = 1;
  for (int line = 0; line < product<Dim>(across); ++line) {
    auto index = unravel<Dim>(line, across);
    for (index[axis] = 0; index[axis] < size[axis]; ++index[axis]) {
      net.col(ravel<Dim>(index, size)) =
          lines.row(index[axis]).segment(line * rows, rows).transpose();
    }
  }
  return net;
}

template <int Dim>
std::array<int, Dim> net_size(const std::array<KnotVector, Dim>& axes) {
  std::array<int, Dim> size;
  for (int a = 0; a < Dim; ++a) size[a] = axes[a].num_functions();
  return size;
}

/// Coefficients of the splines that take given values at the Greville abscissae, column by column.
class GrevilleInterpolation {
 public:
  explicit GrevilleInterpolation(const KnotVector& axis)
      : abscissae_(axis.greville_abscissae()), values_(axis.collocation(abscissae_)) {
    factor_.compute(values_);
  }
  const std::vector<double>& abscissae() const { return abscissae_; }
  const Eigen::SparseMatrix<double>& values() const { return values_; }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& at_abscissae) const {
    return factor_.solve(at_abscissae);
  }

 private:
  std::vector<double> abscissae_;
  Eigen::SparseMatrix<double> values_;
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factor_;
};

/// degree + 2 points inside every span: a polynomial of degree + 1 cannot vanish at all of them.
std::vector<double> sample_points(const KnotVector& axis) {
  std::vector<double> points;
  for (int s = 0; s < axis.num_spans(); ++s) {
    for (int k = 0; k < axis.degree() + 2 && axis.span_length(s) > 0; ++k) {
      points.push_back(axis.span_begin(s) + axis.span_length(s) * (k + 0.5) / (axis.degree() + 2));
    }
  }
  return points;
}

Eigen::VectorXd from_middle(const std::vector<double>& abscissae, const KnotVector& axis) {
  const Eigen::Map<const Eigen::VectorXd> u(abscissae.data(), std::ssize(abscissae));
  return u.array() - 0.5 * (axis.begin() + axis.end());
}

}  // namespace

template <int Dim>
NurbsIdentity<Dim> nearest_identity(const std::array<KnotVector, Dim>& axes,
                                    const Eigen::VectorXd& weights) {
  const auto size = net_size<Dim>(axes);
  NurbsIdentity<Dim> identity;
  identity.control_points.resize(Dim, weights.size());
  const bool rational = weights.minCoeff() != weights.maxCoeff();
  for (int a = 0; a < Dim; ++a) {
    const KnotVector& axis = axes[a];
    if (!rational) {
      const auto greville = axis.greville_abscissae();
      for (int i = 0; i < weights.size(); ++i) {
        identity.control_points(a, i) = greville[unravel<Dim>(i, size)[a]];
      }
      continue;
    }
    const Eigen::MatrixXd w = lines_of<Dim>(weights.transpose(), size, a);
    const GrevilleInterpolation interpolation(axis);
    const Eigen::MatrixXd p = interpolation.solve(
        from_middle(interpolation.abscissae(), axis).asDiagonal() * (interpolation.values() * w));
    const auto points = sample_points(axis);
    const Eigen::SparseMatrix<double> values = axis.collocation(points);
    const Eigen::MatrixXd total = values * w;
    const Eigen::MatrixXd miss = values * p - from_middle(points, axis).asDiagonal() * total;
    identity.error = std::max(identity.error, miss.cwiseQuotient(total).cwiseAbs().maxCoeff() /
                                                  (axis.end() - axis.begin()));
    const Eigen::MatrixXd g = p.cwiseQuotient(w).array() + 0.5 * (axis.begin() + axis.end());
    identity.control_points.row(a) = net_of<Dim>(g, 1, size, a);
  }
  return identity;
}

template <int Dim>
double largest_change(const std::array<KnotVector, Dim>& axes, const Eigen::VectorXd& weights) {
  const auto size = net_size<Dim>(axes);
  double largest = 1;
  for (int a = 0; a < Dim; ++a) {
    const Eigen::MatrixXd w = lines_of<Dim>(weights.transpose(), size, a);
    const int taps = axes[a].degree() + 1;
    for (int s = 0; s < axes[a].num_spans(); ++s) {
      if (!(axes[a].span_length(s) > 0)) continue;
      Eigen::MatrixXd extraction(taps, taps);
      for (int r = 0; r < taps; ++r) {
        for (int k = 0; k < taps; ++k) extraction(k, r) = axes[a].ordinates(s, r)[k];
      }
      const Eigen::MatrixXd ordinates = extraction * w.middleRows(s, taps);
      largest = std::max(
          largest, (ordinates.colwise().maxCoeff().array() / ordinates.colwise().minCoeff().array())
                       .maxCoeff());
    }
  }
  return largest;
}

template <int Dim>
std::array<KnotVector, Dim> weight_axes(const NurbsNet<Dim>& net) {
  std::array<KnotVector, Dim> axes;
  for (int a = 0; a < Dim; ++a) axes[a] = KnotVector(net.degree, net.knots[a]).one_degree_less();
  return axes;
}

template <int Dim>
Eigen::VectorXd elevated_weights(const NurbsNet<Dim>& net, const Eigen::VectorXd& coefficients) {
  const auto coarse = weight_axes(net);
  auto size = net_size<Dim>(coarse);
  if (coefficients.size() != product<Dim>(size)) {
    throw InvalidInput(message("elevated_weights: ", coefficients.size(), " coefficients given, ",
                               product<Dim>(size), " expected."));
  }
  if (!coefficients.allFinite() || !(coefficients.minCoeff() > 0)) {
    throw InvalidInput("elevated_weights: the coefficients must be finite and positive.");
  }
  Eigen::MatrixXd result = coefficients.transpose();
  for (int a = 0; a < Dim; ++a) {
    const GrevilleInterpolation fine(KnotVector(net.degree, net.knots[a]));
    const Eigen::MatrixXd lines =
        fine.solve(coarse[a].collocation(fine.abscissae()) * lines_of<Dim>(result, size, a));
    size[a] = static_cast<int>(lines.rows());
    result = net_of<Dim>(lines, 1, size, a);
  }
  return result.transpose();
}

template <int Dim>
NurbsRefinement<Dim> insert_knots(const NurbsBasis<Dim>& basis,
                                  const Eigen::Ref<const Eigen::MatrixXd>& control_points, int axis,
                                  const std::vector<double>& knots) {
  if (control_points.cols() != basis.num_control_points() || axis < 0 || axis >= Dim) {
    throw InvalidInput(message("insert_knots: ", control_points.cols(), " control points and axis ",
                               axis, " given; the basis has ", basis.num_control_points(), " and ",
                               Dim, " axes."));
  }
  // Homogeneous: the weights in the last row.
  const Eigen::Index rows = control_points.rows();
  Eigen::MatrixXd net(rows + 1, control_points.cols());
  net << control_points * basis.net().weights.asDiagonal(), basis.net().weights.transpose();
  KnotVector vector = basis.axes()[axis];
  auto size = basis.net_size();
  Eigen::MatrixXd lines = lines_of<Dim>(net, size, axis);
  for (double u : knots) {
    KnotVector finer = vector.with_knot(u);
    lines = (vector.insertion(u) * lines).eval();
    vector = std::move(finer);
  }
  size[axis] = vector.num_functions();
  net = net_of<Dim>(lines, rows + 1, size, axis);

  NurbsNet<Dim> finer = basis.net();
  finer.knots[axis] = vector.knots();
  finer.weights = net.row(rows);
  if (!basis.is_rational()) finer.weights.setConstant(basis.net().weights[0]);
  NurbsRefinement<Dim> result;
  result.control_points = net.topRows(rows) * finer.weights.cwiseInverse().asDiagonal();
  result.basis = std::make_shared<NurbsBasis<Dim>>(std::move(finer), basis.reproduces_affine_maps()
                                                                         ? AffineMaps::kRequired
                                                                         : AffineMaps::kNotNeeded);
  return result;
}

template <int Dim>
NurbsRefinement<Dim> refined(const NurbsBasis<Dim>& basis,
                             const Eigen::Ref<const Eigen::MatrixXd>& control_points) {
  NurbsRefinement<Dim> result{std::make_shared<NurbsBasis<Dim>>(basis), control_points};
  for (int a = 0; a < Dim; ++a) {
    const KnotVector& axis = basis.axes()[a];
    std::vector<double> middles;
    for (int s = 0; s < axis.num_spans(); ++s) {
      const double length = axis.span_length(s);
      if (length > 0) middles.push_back(axis.span_begin(s) + 0.5 * length);
    }
    const Eigen::MatrixXd before = std::move(result.control_points);
    result = insert_knots<Dim>(*result.basis, before, a, middles);
  }
  return result;
}

#define CREASE_INSTANTIATE(Dim)                                                                    \
  template NurbsIdentity<Dim> nearest_identity<Dim>(const std::array<KnotVector, Dim>&,            \
                                                    const Eigen::VectorXd&);                       \
  template double largest_change<Dim>(const std::array<KnotVector, Dim>&, const Eigen::VectorXd&); \
  template std::array<KnotVector, Dim> weight_axes<Dim>(const NurbsNet<Dim>&);                     \
  template Eigen::VectorXd elevated_weights(const NurbsNet<Dim>&, const Eigen::VectorXd&);         \
  template NurbsRefinement<Dim> insert_knots(const NurbsBasis<Dim>&,                               \
                                             const Eigen::Ref<const Eigen::MatrixXd>&, int,        \
                                             const std::vector<double>&);                          \
  template NurbsRefinement<Dim> refined(const NurbsBasis<Dim>&,                                    \
                                        const Eigen::Ref<const Eigen::MatrixXd>&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
