#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "Core/Point.h"
#include "Core/Raster.h"
#include "Transforms/BlockHessian.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// Sums of symmetric curvature matrices over blocks of samples: G_b = sum over the block of
/// d^2 E / dT^2, as (xx, xy, yy) or (xx, xy, xz, yy, yz, zz). A block is kBlock samples wide along
/// every axis; samples beyond the raster count nothing.
template <int Dim>
struct CurvatureBlocks {
  static constexpr int kBlock = 4;
  explicit CurvatureBlocks(const std::array<int, Dim>& raster_size) {
    std::int64_t n = 1;
    for (int a = 0; a < Dim; ++a) n *= blocks[a] = (raster_size[a] + kBlock - 1) / kBlock;
    for (auto& component : sums) component.assign(static_cast<std::size_t>(n), 0.0f);
  }
  /// Index of the first block of the block row that holds raster row r.
  std::int64_t row_offset(std::int64_t r, const std::array<int, Dim>& raster_size) const {
    if constexpr (Dim == 2) return (r / kBlock) * blocks[0];
    const std::int64_t j = r % raster_size[1], k = r / raster_size[1];
    return ((k / kBlock) * blocks[1] + j / kBlock) * blocks[0];
  }
  std::array<int, Dim> blocks{};
  std::array<std::vector<float>, kNumSecondDerivatives<Dim>> sums;
};

/// A spline basis bound to the samples of a raster: u(x) = sum_i phi_i B_i(x) for whole rows at a time,
/// and the adjoint, which carries force fields back onto the control points. There is no loop over
/// samples times parameters anywhere: cores of patches are polynomials evaluated by Horner's rule and
/// summed by moments, what is left is a compact sparse product.
///
/// Rows are the raster's runs along its first axis (Raster::row_start). Values are single precision;
/// control points and sums over rows are double. Thread-safe: all state of a pass is in the arguments.
template <int Dim>
class BoundGrid {
 public:
  using Raw = float;
  /// What a pass needs of the control points (core polynomials, single-precision copies).
  struct Coefficients {
    virtual ~Coefficients() = default;
  };
  /// Sums of the adjoint over some rows.
  struct Accumulator {
    virtual ~Accumulator() = default;
  };

  virtual ~BoundGrid() = default;
  virtual const Raster<Dim>& raster() const = 0;
  virtual int num_control_points() const = 0;
  /// Half-open range of samples of row r outside which no sample lies in the domain.
  virtual std::pair<int, int> row_range(std::int64_t row) const = 0;
  /// Sets inside[i] = 1 for the samples of the row in the domain, 0 for the others (size[0] entries).
  virtual void coverage(std::int64_t row, std::span<std::uint8_t> inside) const = 0;

  /// Control points as the passes below want them.
  /// @param control_points  Dim x num_control_points: phi, mm.
  virtual std::unique_ptr<Coefficients> prepare(
      const Eigen::Ref<const ControlPoints<Dim>>& control_points) const = 0;
  /// Writes component a of u to out[a][i] for all i in row_range(row); samples there that are outside
  /// the domain get 0. The buffers hold padded_row_size(raster) entries.
  virtual void map_row(const Coefficients& coefficients, std::int64_t row,
                       const std::array<float*, Dim>& out) const = 0;

  /// Sums at zero, for one thread.
  virtual std::unique_ptr<Accumulator> new_accumulator() const = 0;
  /// Adds the row's forces: force[a][i] for i in row_range(row); forces outside the domain count nothing.
  virtual void add_row(Accumulator& sums, std::int64_t row,
                       const std::array<const float*, Dim>& force) const = 0;
  /// gradient (Dim x num_control_points) += sum_x F(x) B_i(x), accumulators added in the order given.
  virtual void finish(std::span<const std::unique_ptr<Accumulator>> sums,
                      Eigen::Ref<ControlPoints<Dim>> gradient) const = 0;
  /// hessian(i, k) += sum_b scale * G_b <B_i B_k>_b, the mean over one or more covered samples of the block:
  /// the one nearest to its middle where functions vary little over a block, more where they do.
  virtual void add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                             BlockHessian<Dim>& hessian) const = 0;
};

/// Row buffers are this long so that kernels may sweep them with full vectors.
template <int Dim>
std::size_t padded_row_size(const Raster<Dim>& raster) {
  return (static_cast<std::size_t>(raster.size[0]) + 15) / 16 * 16 + 16;
}

}  // namespace crease
