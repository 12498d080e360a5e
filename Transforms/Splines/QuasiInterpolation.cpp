#include "Transforms/Splines/QuasiInterpolation.h"

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kSide = -1.0 / 6, kMiddle = 4.0 / 3;

template <int Dim>
int product(const std::array<int, Dim>& size) {
  int n = 1;
  for (int s : size) n *= s;
  return n;
}

/// visit(wide, narrow) for every entry of the narrower net and its neighbour to the left in the wider
/// one, two longer along the axis; the next along the axis are `stride` apart.
template <int Dim, typename Visit>
void for_each_triple(std::array<int, Dim> wide, int axis, Visit&& visit) {
  int stride = 1, after = 1;
  for (int a = 0; a < axis; ++a) stride *= wide[a];
  for (int a = axis + 1; a < Dim; ++a) after *= wide[a];
  const int count = wide[axis] - 2;
  for (int outer = 0; outer < after; ++outer) {
    for (int i = 0; i < count; ++i) {
      for (int inner = 0; inner < stride; ++inner) {
        visit((outer * (count + 2) + i) * stride + inner, (outer * count + i) * stride + inner,
              stride);
      }
    }
  }
}

}  // namespace

template <int Dim>
QuasiInterpolation<Dim>::QuasiInterpolation(const Raster<Dim>& raster, double span)
    : basis_(covering_lattice(raster, span), 3), node_size_(basis_.net_size()) {
  const Raster<Dim> net = basis_.control_raster();
  for (int& s : node_size_) s += 2;
  nodes_.resize(Dim, product<Dim>(node_size_));
  for (int n = 0; n < nodes_.cols(); ++n) {
    Vector<Dim> index;
    for (int a = 0, rest = n; a < Dim; rest /= node_size_[a], ++a) {
      index[a] = rest % node_size_[a] - 1;
    }
    nodes_.col(n) = net.point(index);
  }
}

template <int Dim>
Eigen::MatrixXd QuasiInterpolation<Dim>::control_points(
    const Eigen::Ref<const Eigen::MatrixXd>& values) const {
  if (values.cols() != nodes_.cols()) {
    throw InvalidInput(message("QuasiInterpolation: ", values.cols(), " values given, ",
                               nodes_.cols(), " expected."));
  }
  Eigen::MatrixXd wide = values;
  auto size = node_size_;
  for (int a = 0; a < Dim; ++a) {
    auto narrower = size;
    narrower[a] -= 2;
    Eigen::MatrixXd narrow(values.rows(), product<Dim>(narrower));
    for_each_triple<Dim>(size, a, [&](int from, int to, int step) {
      narrow.col(to) =
          kMiddle * wide.col(from + step) + kSide * (wide.col(from) + wide.col(from + 2 * step));
    });
    wide = std::move(narrow);
    size = narrower;
  }
  return wide;
}

template <int Dim>
Eigen::MatrixXd QuasiInterpolation<Dim>::adjoint(
    const Eigen::Ref<const Eigen::MatrixXd>& gradient) const {
  if (gradient.cols() != basis_.num_control_points()) {
    throw InvalidInput(message("QuasiInterpolation: a gradient by ", gradient.cols(),
                               " control points given, ", basis_.num_control_points(),
                               " expected."));
  }
  Eigen::MatrixXd narrow = gradient;
  auto size = basis_.net_size();
  for (int a = Dim - 1; a >= 0; --a) {
    size[a] += 2;
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(gradient.rows(), product<Dim>(size));
    for_each_triple<Dim>(size, a, [&](int to, int from, int step) {
      wide.col(to) += kSide * narrow.col(from);
      wide.col(to + step) += kMiddle * narrow.col(from);
      wide.col(to + 2 * step) += kSide * narrow.col(from);
    });
    narrow = std::move(wide);
  }
  return narrow;
}

template class QuasiInterpolation<2>;
template class QuasiInterpolation<3>;

}  // namespace crease
