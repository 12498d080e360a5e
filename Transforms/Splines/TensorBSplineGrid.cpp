#include "Transforms/Splines/TensorBSplineGrid.h"

#include <cmath>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Transforms/ControlPointSums.h"
#include "Transforms/Splines/TensorBSplineCurvature.h"

namespace crease {
namespace {

constexpr double kTolerance = 1e-9;  // of a span, as TensorBSplineBasis

template <int Dim>
struct NetCoefficients final : BoundGrid<Dim>::Coefficients {
  std::array<std::vector<double>, Dim> phi;
};

template <int Dim>
struct NetSums final : BoundGrid<Dim>::Accumulator {
  NetSums(int num_control_points, int row_size) : sums(num_control_points, row_size) {}
  ControlPointSums<Dim> sums;
};

/// Spans per sample along every axis, and between axes.
template <int Dim>
Matrix<Dim> spans_per_sample(const TensorLattice<Dim>& lattice, const Raster<Dim>& raster) {
  return lattice.spacing.cwiseInverse().asDiagonal() * lattice.direction.transpose() *
         raster.index_to_point();
}

/// Polynomials in s, rewritten in s - 1/2, where powers stay small: [power][function].
std::vector<double> centred_polynomials(int degree) {
  const auto at_zero = bspline_polynomials(degree);
  std::vector<double> centred(static_cast<std::size_t>((degree + 1) * (degree + 1)), 0.0);
  for (int t = 0; t <= degree; ++t) {
    double binomial = 1;  // t over u
    for (int u = 0; u <= t; ++u) {
      for (int r = 0; r <= degree; ++r) {
        centred[u * (degree + 1) + r] += at_zero[t][r] * binomial * std::ldexp(1.0, u - t);
      }
      binomial = binomial * (t - u) / (u + 1);
    }
  }
  return centred;
}

}  // namespace

template <int Dim>
bool TensorBSplineGrid<Dim>::can_bind(const TensorLattice<Dim>& lattice,
                                      const Raster<Dim>& raster) {
  const Matrix<Dim> step = spans_per_sample(lattice, raster);
  for (int a = 0; a < Dim; ++a) {
    if (!(step(a, a) > 0)) return false;
    for (int b = 0; b < Dim; ++b) {
      if (a != b && !(std::abs(step(a, b)) * raster.size[b] < 1e-7)) return false;
    }
  }
  return true;
}

template <int Dim>
TensorBSplineGrid<Dim>::TensorBSplineGrid(const TensorLattice<Dim>& lattice, int degree,
                                          const Raster<Dim>& raster)
    : raster_(raster), degree_(degree), polynomials_(centred_polynomials(degree)) {
  if (!can_bind(lattice, raster)) {
    throw InvalidInput("TensorBSplineGrid: the raster's axes are not those of the lattice.");
  }
  const Matrix<Dim> step = spans_per_sample(lattice, raster);
  const Vector<Dim> start = lattice.coordinates(raster.origin);
  local_.assign(padded_row_size(raster), 0.0f);
  for (int a = 0; a < Dim; ++a) {
    Axis& axis = axes_[a];
    axis.num_spans = lattice.spans[a];
    axis.net_size = lattice.spans[a] + degree;
    axis.span.assign(static_cast<std::size_t>(raster.size[a]), 0);
    axis.weights.assign(axis.span.size() * (degree + 1), 0.0);
    axis.begin = raster.size[a];
    for (int i = 0; i < raster.size[a]; ++i) {
      const double t = start[a] + i * step(a, a);
      if (!(t >= -kTolerance && t <= lattice.spans[a] + kTolerance)) continue;
      axis.begin = std::min(axis.begin, i);
      axis.end = i + 1;
      axis.span[i] = std::clamp(static_cast<int>(t), 0, lattice.spans[a] - 1);
      const double s = std::clamp(t - axis.span[i], 0.0, 1.0);
      const auto segment = bspline_segment(degree, s, 0);
      for (int r = 0; r <= degree; ++r) axis.weights[i * (degree + 1) + r] = segment.value[r];
      if (a == 0) local_[i] = static_cast<float>(s - 0.5);
    }
    axis.begin = std::min(axis.begin, axis.end);
  }
  const Axis& x = axes_[0];
  for (int i = x.begin; i < x.end; ++i) {
    if (runs_.empty() || runs_.back().span != x.span[i]) runs_.push_back({i, i, x.span[i]});
    runs_.back().end = i + 1;
  }
}

template <int Dim>
int TensorBSplineGrid<Dim>::num_control_points() const {
  int n = 1;
  for (const Axis& axis : axes_) n *= axis.net_size;
  return n;
}

template <int Dim>
bool TensorBSplineGrid<Dim>::covers(std::int64_t row) const {
  const auto within = [](const Axis& axis, std::int64_t i) {
    return i >= axis.begin && i < axis.end;
  };
  if constexpr (Dim == 2) return within(axes_[1], row);
  return within(axes_[1], row % raster_.size[1]) && within(axes_[Dim - 1], row / raster_.size[1]);
}

template <int Dim>
std::pair<int, int> TensorBSplineGrid<Dim>::row_range(std::int64_t row) const {
  return covers(row) ? std::pair(axes_[0].begin, axes_[0].end) : std::pair(0, 0);
}

template <int Dim>
void TensorBSplineGrid<Dim>::coverage(std::int64_t row, std::span<std::uint8_t> inside) const {
  const auto [begin, end] = row_range(row);
  std::ranges::fill(inside, std::uint8_t{0});
  std::fill(inside.begin() + begin, inside.begin() + end, std::uint8_t{1});
}

template <int Dim>
typename TensorBSplineGrid<Dim>::NetRows TensorBSplineGrid<Dim>::net_rows(std::int64_t row) const {
  const auto j = static_cast<std::size_t>(Dim == 2 ? row : row % raster_.size[1]);
  const std::size_t taps = static_cast<std::size_t>(degree_) + 1;
  NetRows rows;
  const auto add_plane = [&](int first_row, double weight) {
    for (std::size_t r = 0; r < taps; ++r, ++rows.count) {
      rows.number[rows.count] = first_row + axes_[1].span[j] + static_cast<int>(r);
      rows.weight[rows.count] = weight * axes_[1].weights[j * taps + r];
    }
  };
  if constexpr (Dim == 2) {
    add_plane(0, 1.0);
  } else {
    const auto k = static_cast<std::size_t>(row / raster_.size[1]);
    for (std::size_t r = 0; r < taps; ++r) {
      add_plane(axes_[1].net_size * (axes_[2].span[k] + static_cast<int>(r)),
                axes_[2].weights[k * taps + r]);
    }
  }
  return rows;
}

template <int Dim>
TensorRowPlan TensorBSplineGrid<Dim>::plan() const {
  return {degree_,       axes_[0].net_size,  runs_.data(), static_cast<int>(runs_.size()),
          local_.data(), polynomials_.data()};
}

template <int Dim>
std::unique_ptr<typename TensorBSplineGrid<Dim>::Coefficients> TensorBSplineGrid<Dim>::prepare(
    const Eigen::Ref<const ControlPoints<Dim>>& control_points) const {
  auto coefficients = std::make_unique<NetCoefficients<Dim>>();
  for (int a = 0; a < Dim; ++a) {
    const Eigen::RowVectorXd row = control_points.row(a);
    coefficients->phi[a].assign(row.data(), row.data() + row.size());
  }
  return coefficients;
}

template <int Dim>
void TensorBSplineGrid<Dim>::map_row(const Coefficients& coefficients, std::int64_t row,
                                     const std::array<float*, Dim>& out) const {
  if (!covers(row)) return;
  const auto& phi = static_cast<const NetCoefficients<Dim>&>(coefficients).phi;
  const NetRows net = net_rows(row);
  const auto kernel = cpu_has_avx2() ? avx2::tensor_map_row : baseline::tensor_map_row;
  std::vector<double> sums(static_cast<std::size_t>(axes_[0].net_size));
  std::array<const double*, std::tuple_size_v<decltype(net.number)>> rows;
  for (int a = 0; a < Dim; ++a) {
    for (int n = 0; n < net.count; ++n) {
      rows[n] = phi[a].data() + static_cast<std::ptrdiff_t>(net.number[n]) * axes_[0].net_size;
    }
    kernel(plan(), rows.data(), net.weight.data(), net.count, sums.data(), out[a]);
  }
}

template <int Dim>
std::unique_ptr<typename TensorBSplineGrid<Dim>::Accumulator>
TensorBSplineGrid<Dim>::new_accumulator() const {
  return std::make_unique<NetSums<Dim>>(num_control_points(), axes_[0].net_size);
}

template <int Dim>
void TensorBSplineGrid<Dim>::add_row(Accumulator& accumulator, std::int64_t row,
                                     const std::array<const float*, Dim>& force) const {
  if (!covers(row)) return;
  auto& target = static_cast<NetSums<Dim>&>(accumulator).sums;
  const NetRows net = net_rows(row);
  const auto kernel = cpu_has_avx2() ? avx2::tensor_adjoint_row : baseline::tensor_adjoint_row;
  std::vector<double> sums(static_cast<std::size_t>(axes_[0].net_size));
  std::array<double*, std::tuple_size_v<decltype(net.number)>> rows;
  for (int a = 0; a < Dim; ++a) {
    for (int n = 0; n < net.count; ++n) {
      rows[n] = target.block(net.number[n]) + static_cast<std::ptrdiff_t>(a) * axes_[0].net_size;
    }
    kernel(plan(), force[a], rows.data(), net.weight.data(), net.count, sums.data());
  }
}

template <int Dim>
void TensorBSplineGrid<Dim>::finish(std::span<const std::unique_ptr<Accumulator>> sums,
                                    Eigen::Ref<ControlPoints<Dim>> gradient) const {
  for (const auto& s : sums) static_cast<const NetSums<Dim>&>(*s).sums.add_to(gradient);
}

template <int Dim>
void TensorBSplineGrid<Dim>::add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                                           BlockHessian<Dim>& hessian) const {
  std::array<TensorBlockAxis, Dim> block_axes;
  for (int a = 0; a < Dim; ++a) {
    const Axis& axis = axes_[a];
    block_axes[a] = TensorBlockAxis(degree_, axis.num_spans, axis.begin, axis.end, axis.span,
                                    axis.weights, CurvatureBlocks<Dim>::kBlock);
  }
  add_tensor_curvature<Dim>(block_axes, blocks, scale, hessian);
}

template class TensorBSplineGrid<2>;
template class TensorBSplineGrid<3>;

}  // namespace crease
