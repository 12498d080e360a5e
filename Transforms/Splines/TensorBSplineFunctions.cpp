#include "Transforms/Splines/TensorBSplineFunctions.h"

namespace crease {
namespace {

/// The other axes' share of a product and of its derivatives; the first axis' factors come on top.
struct Across {
  double value = 1;
  double y = 0, z = 0;            // first derivatives
  double yy = 0, yz = 0, zz = 0;  // second derivatives
};

Across across(const BSplineSegment& y, int j) {
  return {y.value[j], y.first[j], 0, y.second[j], 0, 0};
}

Across across(const BSplineSegment& y, int j, const BSplineSegment& z, int k) {
  return {y.value[j] * z.value[k],  y.first[j] * z.value[k], y.value[j] * z.first[k],
          y.second[j] * z.value[k], y.first[j] * z.first[k], y.value[j] * z.second[k]};
}

}  // namespace

template <int Dim>
Matrix<kNumSecondDerivatives<Dim>> second_derivatives_transform(const Matrix<Dim>& p) {
  Matrix<kNumSecondDerivatives<Dim>> result;
  for (int a = 0, row = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++row) {
      for (int c = 0, column = 0; c < Dim; ++c) {
        for (int d = c; d < Dim; ++d, ++column) {
          result(row, column) = p(a, c) * p(b, d) + (c == d ? 0.0 : p(a, d) * p(b, c));
        }
      }
    }
  }
  return result;
}

template <int Dim>
TensorBSplineFunctions<Dim>::TensorBSplineFunctions(const TensorLattice<Dim>& lattice, int degree)
    : degree_(degree),
      to_space_(lattice.direction * lattice.spacing.cwiseInverse().asDiagonal()),
      second_to_space_(second_derivatives_transform<Dim>(to_space_)) {}

template <int Dim>
int TensorBSplineFunctions<Dim>::count() const {
  const int taps = degree_ + 1;
  return Dim == 2 ? taps * taps : taps * taps * taps;
}

template <int Dim>
void TensorBSplineFunctions<Dim>::evaluate(const Vector<Dim>& local, int derivatives,
                                           BasisValues<Dim>& result) const {
  std::array<BSplineSegment, Dim> axis;
  for (int a = 0; a < Dim; ++a) axis[a] = bspline_segment(degree_, local[a], derivatives);
  multiply(axis, derivatives, result);
}

template <int Dim>
void TensorBSplineFunctions<Dim>::multiply(const std::array<BSplineSegment, Dim>& axis,
                                           int derivatives, BasisValues<Dim>& result) const {
  result.values.resize(count());
  if (derivatives > 0) result.gradients.resize(Dim, count());
  if (derivatives > 1) result.hessians.resize(kNumSecondDerivatives<Dim>, count());

  const BSplineSegment& x = axis[0];
  Eigen::Index n = 0;
  for (int k = 0; k <= (Dim == 3 ? degree_ : 0); ++k) {
    for (int j = 0; j <= degree_; ++j) {
      Across o;
      if constexpr (Dim == 2) o = across(axis[1], j);
      if constexpr (Dim == 3) o = across(axis[1], j, axis[2], k);
      for (int i = 0; i <= degree_; ++i, ++n) {
        result.values[n] = x.value[i] * o.value;
        if (derivatives == 0) continue;
        auto g = result.gradients.col(n);
        g[0] = x.first[i] * o.value;
        g[1] = x.value[i] * o.y;
        if constexpr (Dim == 3) g[2] = x.value[i] * o.z;
        if (derivatives == 1) continue;
        auto h = result.hessians.col(n);
        if constexpr (Dim == 2) {
          h << x.second[i] * o.value, x.first[i] * o.y, x.value[i] * o.yy;
        } else {
          h << x.second[i] * o.value, x.first[i] * o.y, x.first[i] * o.z, x.value[i] * o.yy,
              x.value[i] * o.yz, x.value[i] * o.zz;
        }
      }
    }
  }
  for (Eigen::Index c = 0; c < result.gradients.cols() && derivatives > 0; ++c) {
    result.gradients.col(c) = (to_space_ * result.gradients.col(c)).eval();
  }
  for (Eigen::Index c = 0; c < result.hessians.cols() && derivatives > 1; ++c) {
    result.hessians.col(c) = (second_to_space_ * result.hessians.col(c)).eval();
  }
}

template Matrix<3> second_derivatives_transform(const Matrix<2>&);
template Matrix<6> second_derivatives_transform(const Matrix<3>&);
template class TensorBSplineFunctions<2>;
template class TensorBSplineFunctions<3>;

}  // namespace crease
