#include "Transforms/Splines/TensorBSplineGrid.h"

#include <cmath>

#include "Core/Cpu.h"
#include "Core/Error.h"
#include "Core/Parallel.h"
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

/// Polynomials in s, rewritten in s - 1/2, where powers stay small, and added to [power][function].
void add_centred(const BSplinePolynomials& at_zero, int degree, std::vector<double>& centred) {
  const std::size_t first = centred.size();
  centred.resize(first + static_cast<std::size_t>((degree + 1) * (degree + 1)), 0.0);
  for (int t = 0; t <= degree; ++t) {
    double binomial = 1;  // t over u
    for (int u = 0; u <= t; ++u) {
      for (int r = 0; r <= degree; ++r) {
        centred[first + u * (degree + 1) + r] += at_zero[t][r] * binomial * std::ldexp(1.0, u - t);
      }
      binomial = binomial * (t - u) / (u + 1);
    }
  }
}

/// The functions of a span by powers of s: the coefficient of s^t is binomial(n, t) times the t-th difference
/// of the Bezier ordinates.
BSplinePolynomials span_polynomials(const KnotVector& axis, int span) {
  BSplinePolynomials result{};
  for (int r = 0; r <= axis.degree(); ++r) {
    auto differences = axis.ordinates(span, r);
    double binomial = 1;
    for (int t = 0; t <= axis.degree(); ++t) {
      result[t][r] = binomial * differences[0];
      for (int k = 0; k + t < axis.degree(); ++k)
        differences[k] = differences[k + 1] - differences[k];
      binomial = binomial * (axis.degree() - t) / (t + 1);
    }
  }
  return result;
}

template <int Dim>
TensorLattice<Dim> axes_of(const ParameterBox<Dim>& box) {
  TensorLattice<Dim> lattice;
  lattice.origin = box.origin;
  lattice.direction = box.direction;
  return lattice;
}

void check_axes(bool same) {
  if (!same) {
    throw InvalidInput("TensorBSplineGrid: the raster's axes are not those of the spline.");
  }
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
bool TensorBSplineGrid<Dim>::can_bind(const ParameterBox<Dim>& box, const Raster<Dim>& raster) {
  return can_bind(axes_of(box), raster);
}

template <int Dim>
TensorBSplineGrid<Dim>::TensorBSplineGrid(const TensorLattice<Dim>& lattice, int degree,
                                          const Raster<Dim>& raster)
    : raster_(raster), degree_(degree) {
  check_axes(can_bind(lattice, raster));
  add_centred(bspline_polynomials(degree), degree, polynomials_);
  const Matrix<Dim> step = spans_per_sample(lattice, raster);
  const Vector<Dim> start = lattice.coordinates(raster.origin);
  local_.assign(padded_row_size(raster), 0.0f);
  for (int a = 0; a < Dim; ++a) {
    start_axis(a, lattice.spans[a]);
    for (int i = 0; i < raster.size[a]; ++i) {
      const double t = start[a] + i * step(a, a);
      if (!(t >= -kTolerance && t <= lattice.spans[a] + kTolerance)) continue;
      const int span = std::clamp(static_cast<int>(t), 0, lattice.spans[a] - 1);
      const double s = std::clamp(t - span, 0.0, 1.0);
      place_sample(a, i, span, bspline_segment(degree, s, 0));
      if (a == 0) local_[i] = static_cast<float>(s - 0.5);
    }
  }
  make_runs();
}

template <int Dim>
TensorBSplineGrid<Dim>::TensorBSplineGrid(const std::array<KnotVector, Dim>& knots,
                                          const ParameterBox<Dim>& box,
                                          const Eigen::VectorXd& weights, const Raster<Dim>& raster)
    : raster_(raster),
      degree_(knots[0].degree()),
      polynomials_per_span_((degree_ + 1) * (degree_ + 1)),
      weights_(weights) {
  check_axes(can_bind(box, raster));
  for (int span = 0; span < knots[0].num_spans(); ++span) {
    add_centred(span_polynomials(knots[0], span), degree_, polynomials_);
  }
  const Matrix<Dim> step = spans_per_sample(axes_of(box), raster);
  const Vector<Dim> start = box.coordinates(raster.origin);
  local_.assign(padded_row_size(raster), 0.0f);
  for (int a = 0; a < Dim; ++a) {
    const KnotVector& axis = knots[a];
    const double slack = kTolerance * (axis.end() - axis.begin());
    start_axis(a, axis.num_spans());
    for (int i = 0; i < raster.size[a]; ++i) {
      const double u = start[a] + i * step(a, a);
      if (!(u >= axis.begin() - slack && u <= axis.end() + slack)) continue;
      const int span = axis.find_span(u);
      place_sample(a, i, span, axis.evaluate(span, u, 0));
      const double s = std::clamp((u - axis.span_begin(span)) / axis.span_length(span), 0.0, 1.0);
      if (a == 0) local_[i] = static_cast<float>(s - 0.5);
    }
  }
  make_runs();
  if (weights_.size() > 0) make_inverse_weights();
}

template <int Dim>
void TensorBSplineGrid<Dim>::start_axis(int a, int num_spans) {
  Axis& axis = axes_[a];
  axis.num_spans = num_spans;
  axis.net_size = num_spans + degree_;
  axis.span.assign(static_cast<std::size_t>(raster_.size[a]), 0);
  axis.weights.assign(axis.span.size() * (degree_ + 1), 0.0);
}

template <int Dim>
void TensorBSplineGrid<Dim>::place_sample(int a, int i, int span, const BSplineSegment& segment) {
  Axis& axis = axes_[a];
  if (axis.begin == axis.end) axis.begin = i;
  axis.end = i + 1;
  axis.span[i] = span;
  for (int r = 0; r <= degree_; ++r) axis.weights[i * (degree_ + 1) + r] = segment.value[r];
}

template <int Dim>
void TensorBSplineGrid<Dim>::make_runs() {
  const Axis& x = axes_[0];
  for (int i = x.begin; i < x.end; ++i) {
    if (runs_.empty() || runs_.back().span != x.span[i]) runs_.push_back({i, i, x.span[i]});
    runs_.back().end = i + 1;
  }
}

template <int Dim>
void TensorBSplineGrid<Dim>::make_inverse_weights() {
  const auto size = static_cast<std::size_t>(raster_.size[0]);
  inverse_weight_.assign(static_cast<std::size_t>(raster_.num_samples()), 0.0f);
  parallel_for(raster_.num_rows(), [&](std::int64_t row) {
    if (!covers(row)) return;
    const NetRows net = net_rows(row);
    std::vector<double> sums(static_cast<std::size_t>(axes_[0].net_size), 0.0);
    for (int n = 0; n < net.count; ++n) {
      for (std::size_t x = 0; x < sums.size(); ++x) {
        sums[x] +=
            net.weight[n] * weights_[static_cast<Eigen::Index>(net.number[n] * sums.size() + x)];
      }
    }
    for (int i = axes_[0].begin; i < axes_[0].end; ++i) {
      double total = 0;
      for (int r = 0; r <= degree_; ++r) {
        total += axes_[0].weights[i * (degree_ + 1) + r] * sums[axes_[0].span[i] + r];
      }
      inverse_weight_[row * size + i] = static_cast<float>(1 / total);
    }
  });
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
  return {degree_,       axes_[0].net_size,   runs_.data(),         static_cast<int>(runs_.size()),
          local_.data(), polynomials_.data(), polynomials_per_span_};
}

template <int Dim>
std::unique_ptr<typename TensorBSplineGrid<Dim>::Coefficients> TensorBSplineGrid<Dim>::prepare(
    const Eigen::Ref<const ControlPoints<Dim>>& control_points) const {
  auto coefficients = std::make_unique<NetCoefficients<Dim>>();
  for (int a = 0; a < Dim; ++a) {
    Eigen::RowVectorXd row = control_points.row(a);
    if (weights_.size() > 0) row.array() *= weights_.transpose().array();
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
    if (inverse_weight_.empty()) continue;
    const float* inverse = inverse_weight_.data() + row * raster_.size[0];
    for (int i = axes_[0].begin; i < axes_[0].end; ++i) out[a][i] *= inverse[i];
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
  std::vector<float> divided(inverse_weight_.empty() ? 0 : padded_row_size(raster_), 0.0f);
  for (int a = 0; a < Dim; ++a) {
    const float* f = force[a];
    if (!divided.empty()) {
      const float* inverse = inverse_weight_.data() + row * raster_.size[0];
      for (int i = axes_[0].begin; i < axes_[0].end; ++i) divided[i] = f[i] * inverse[i];
      f = divided.data();
    }
    for (int n = 0; n < net.count; ++n) {
      rows[n] = target.block(net.number[n]) + static_cast<std::ptrdiff_t>(a) * axes_[0].net_size;
    }
    kernel(plan(), f, rows.data(), net.weight.data(), net.count, sums.data());
  }
}

template <int Dim>
void TensorBSplineGrid<Dim>::finish(std::span<const std::unique_ptr<Accumulator>> sums,
                                    Eigen::Ref<ControlPoints<Dim>> gradient) const {
  if (weights_.size() == 0) {
    for (const auto& s : sums) static_cast<const NetSums<Dim>&>(*s).sums.add_to(gradient);
    return;
  }
  ControlPoints<Dim> homogeneous = ControlPoints<Dim>::Zero(Dim, gradient.cols());
  for (const auto& s : sums) static_cast<const NetSums<Dim>&>(*s).sums.add_to(homogeneous);
  gradient += homogeneous * weights_.asDiagonal();
}

template <int Dim>
CurvatureBlocks<Dim> TensorBSplineGrid<Dim>::divided_by_weight(
    const CurvatureBlocks<Dim>& blocks) const {
  constexpr int kBlock = CurvatureBlocks<Dim>::kBlock;
  CurvatureBlocks<Dim> result = blocks;
  const auto count = static_cast<int>(blocks.sums[0].size());
  for (int b = 0; b < count; ++b) {
    std::int64_t sample = 0, stride = 1;
    int rest = b;
    bool covered = true;
    for (int a = 0; a < Dim; ++a) {
      const int block = rest % blocks.blocks[a];
      rest /= blocks.blocks[a];
      const int first = std::max(axes_[a].begin, block * kBlock);
      const int last = std::min(axes_[a].end, (block + 1) * kBlock);
      covered = covered && first < last;
      if (covered) sample += stride * std::clamp(block * kBlock + kBlock / 2, first, last - 1);
      stride *= raster_.size[a];
    }
    const float inverse = covered ? inverse_weight_[sample] : 0.0f;
    for (auto& component : result.sums) component[b] *= inverse * inverse;
  }
  return result;
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
  if (weights_.size() == 0) {
    add_tensor_curvature<Dim>(block_axes, blocks, scale, hessian);
    return;
  }
  BlockHessian<Dim> homogeneous = hessian;
  homogeneous.set_zero();
  add_tensor_curvature<Dim>(block_axes, divided_by_weight(blocks), scale, homogeneous);
  const HessianPattern& pattern = hessian.pattern();
  for (int i = 0; i < pattern.size(); ++i) {
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s) {
      hessian.block(s) += weights_[i] * weights_[pattern.columns()[s]] * homogeneous.block(s);
    }
  }
}

template class TensorBSplineGrid<2>;
template class TensorBSplineGrid<3>;

}  // namespace crease
