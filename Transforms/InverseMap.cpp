#include "Transforms/InverseMap.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/DisplacementField.h"

namespace crease {
namespace {

constexpr double kTolerance = 1e-8;  // of the grid's spacing
constexpr double kSamplesPerBin = 4;

template <int Dim>
Point<Dim> unresolved() {
  return Point<Dim>::Constant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

template <int Dim>
InverseMap<Dim>::InverseMap(const Transform<Dim>& transform, const Raster<Dim>& grid)
    : transform_(transform), grid_(grid), tolerance_(kTolerance * grid.spacing.minCoeff()) {
  if (grid.num_samples() == 0) throw InvalidInput("InverseMap: the grid has no samples.");
  mapped_ = displacement_field(transform, grid);
  const Vector<Dim> step = grid.index_to_point().col(0);
  for (std::int64_t n = 0; n < mapped_.cols(); ++n) {
    mapped_.col(n) += grid.row_start(n / grid.size[0]) + double(n % grid.size[0]) * step;
    box_.add(mapped_.col(n));
  }
  const double bins = std::max(1.0, static_cast<double>(mapped_.cols()) / kSamplesPerBin);
  const Vector<Dim> size = box_.size().cwiseMax(1e-6 * grid.spacing);
  const double edge = std::pow(size.prod() / bins, 1.0 / Dim);
  int total = 1;
  for (int a = 0; a < Dim; ++a) {
    num_bins_[a] = std::clamp(static_cast<int>(size[a] / edge), 1, 4096);
    total *= num_bins_[a];
  }
  const auto number = [&](const std::array<int, Dim>& bin) {
    int n = bin[Dim - 1];
    for (int a = Dim - 2; a >= 0; --a) n = n * num_bins_[a] + bin[a];
    return n;
  };
  bin_start_.assign(static_cast<std::size_t>(total) + 1, 0);
  std::vector<int> bin(static_cast<std::size_t>(mapped_.cols()));
  for (std::int64_t n = 0; n < mapped_.cols(); ++n) {
    bin[n] = number(bin_of(mapped_.col(n)));
    ++bin_start_[static_cast<std::size_t>(bin[n]) + 1];
  }
  for (std::size_t b = 1; b < bin_start_.size(); ++b) bin_start_[b] += bin_start_[b - 1];
  std::vector<int> next(bin_start_.begin(), bin_start_.end() - 1);
  bin_samples_.resize(bin.size());
  for (std::size_t n = 0; n < bin.size(); ++n) {
    bin_samples_[static_cast<std::size_t>(next[bin[n]]++)] = static_cast<std::int64_t>(n);
  }
}

template <int Dim>
std::array<int, Dim> InverseMap<Dim>::bin_of(const Point<Dim>& y) const {
  std::array<int, Dim> bin;
  for (int a = 0; a < Dim; ++a) {
    const double size = std::max(box_.size()[a], std::numeric_limits<double>::min());
    const double t = (y[a] - box_.lower[a]) / size * num_bins_[a];
    bin[a] = static_cast<int>(std::clamp(t, 0.0, num_bins_[a] - 1.0));
  }
  return bin;
}

// Rings of bins around y's own, until a sample was found and no nearer one can follow.
template <int Dim>
std::int64_t InverseMap<Dim>::nearest_sample(const Point<Dim>& y) const {
  const auto centre = bin_of(y);
  double bin_size = std::numeric_limits<double>::infinity();
  for (int a = 0; a < Dim; ++a) bin_size = std::min(bin_size, box_.size()[a] / num_bins_[a]);
  const int last_ring = *std::max_element(num_bins_.begin(), num_bins_.end());
  const Point<Dim> clamped = y.cwiseMax(box_.lower).cwiseMin(box_.upper);

  std::int64_t best = -1;
  double best_distance = std::numeric_limits<double>::infinity();
  const auto visit = [&](int number) {
    for (int s = bin_start_[number]; s < bin_start_[number + 1]; ++s) {
      const double distance = (mapped_.col(bin_samples_[s]) - y).squaredNorm();
      if (distance < best_distance) {
        best_distance = distance;
        best = bin_samples_[s];
      }
    }
  };
  for (int ring = 0; ring <= last_ring; ++ring) {
    const double reached = std::max(0, ring - 1) * bin_size;
    if (best >= 0 && (mapped_.col(best) - clamped).norm() <= reached) break;
    std::array<int, Dim> low, high;
    for (int a = 0; a < Dim; ++a) {
      low[a] = std::max(0, centre[a] - ring);
      high[a] = std::min(num_bins_[a] - 1, centre[a] + ring);
    }
    const int k_low = Dim == 3 ? low[Dim - 1] : 0, k_high = Dim == 3 ? high[Dim - 1] : 0;
    for (int k = k_low; k <= k_high; ++k) {
      for (int j = low[1]; j <= high[1]; ++j) {
        const bool shell =
            std::abs(j - centre[1]) == ring || (Dim == 3 && std::abs(k - centre[Dim - 1]) == ring);
        for (int i = low[0]; i <= high[0]; ++i) {
          if (shell || std::abs(i - centre[0]) == ring) {
            visit(i + num_bins_[0] * (j + num_bins_[1] * k));
          }
        }
      }
    }
  }
  return best;
}

template <int Dim>
Point<Dim> InverseMap<Dim>::newton(const Point<Dim>& y, Point<Dim> x) const {
  const double longest = 4 * grid_.spacing.maxCoeff();
  Vector<Dim> residual = transform_.map(x) - y;
  for (int iteration = 0; iteration < 50; ++iteration) {
    if (residual.norm() < tolerance_) return x;
    const Eigen::FullPivLU<Matrix<Dim>> jacobian(transform_.spatial_jacobian(x));
    if (!jacobian.isInvertible()) break;
    Vector<Dim> step = -jacobian.solve(residual);
    if (step.norm() > longest) step *= longest / step.norm();
    bool better = false;
    for (int halving = 0; halving < 12 && !better; ++halving, step *= 0.5) {
      const Point<Dim> trial = x + step;
      const Vector<Dim> trial_residual = transform_.map(trial) - y;
      better = trial_residual.norm() < residual.norm();
      if (better) {
        x = trial;
        residual = trial_residual;
      }
    }
    if (!better) break;
  }
  return residual.norm() < 10 * tolerance_ ? x : unresolved<Dim>();
}

template <int Dim>
Point<Dim> InverseMap<Dim>::fixed_point(const Point<Dim>& y, Point<Dim> x) const {
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Vector<Dim> residual = transform_.map(x) - y;
    if (residual.norm() < 10 * tolerance_) return x;
    if (!(residual.norm() < 1e3 * box_.diagonal())) break;
    x -= residual;
  }
  return unresolved<Dim>();
}

template <int Dim>
Point<Dim> InverseMap<Dim>::operator()(const Point<Dim>& y) const {
  if (!y.allFinite()) return unresolved<Dim>();
  const std::int64_t n = nearest_sample(y);
  if (n < 0) return unresolved<Dim>();
  const Point<Dim> start = grid_.row_start(n / grid_.size[0]) +
                           double(n % grid_.size[0]) * grid_.index_to_point().col(0);
  Point<Dim> x = newton(y, start);
  if (!x.allFinite()) x = fixed_point(y, start);
  return x.allFinite() ? x : fixed_point(y, y);
}

template <int Dim>
InverseField<Dim> invert(const Transform<Dim>& transform, const Raster<Dim>& grid,
                         const Raster<Dim>& wanted) {
  const InverseMap<Dim> inverse(transform, grid);
  InverseField<Dim> field;
  field.displacements.resize(Dim, wanted.num_samples());
  const Vector<Dim> step = wanted.index_to_point().col(0);
  parallel_for(wanted.num_rows(), [&](std::int64_t row) {
    const Point<Dim> start = wanted.row_start(row);
    for (int i = 0; i < wanted.size[0]; ++i) {
      const Point<Dim> y = start + i * step;
      field.displacements.col(row * wanted.size[0] + i) = inverse(y) - y;
    }
  });
  for (Eigen::Index n = 0; n < field.displacements.cols(); ++n) {
    field.num_unresolved += std::isnan(field.displacements(0, n));
  }
  return field;
}

template class InverseMap<2>;
template class InverseMap<3>;
template InverseField<2> invert(const Transform<2>&, const Raster<2>&, const Raster<2>&);
template InverseField<3> invert(const Transform<3>&, const Raster<3>&, const Raster<3>&);

}  // namespace crease
