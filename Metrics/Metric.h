#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "Images/Interpolator.h"

namespace crease {

/// Where a metric writes what it finds along one row of samples. Entry i belongs to sample i.
template <int Dim>
struct ForceRow {
  /// dE/dT(x) per sample, sample volume included; null when no force is wanted.
  std::array<float*, Dim> force{};
  /// Positive semi-definite d^2E/dT^2 (xx, xy, yy; xx, xy, xz, yy, yz, zz), *added* to entry i / 4: sums
  /// over four samples of the row; null when no curvature is wanted.
  std::array<float*, Dim*(Dim + 1) / 2> curvature{};
};

/// Compares the fixed image with the moving image at mapped points. It never sees a parameter vector:
/// it returns a value and, per sample, the derivative of the value by the mapped point (the force).
///
/// Work is done row by row so that it can be fused with the transform's mapping and adjoint: a pass
/// calls evaluate_row for every row of the fixed raster (rows of one tile in order, tiles on any
/// thread, each with its own Sums), then finish_pass with all tiles' sums in order. The last of
/// num_passes() passes writes forces.
template <int Dim>
class Metric {
 public:
  /// Sums over a tile of rows.
  struct Sums {
    virtual ~Sums() = default;
    double value = 0;          ///< the metric's own partial value
    double weight = 0;         ///< sum of the weights of the samples
    double weight_inside = 0;  ///< same, of those that fall inside the moving image and its mask
  };

  virtual ~Metric() = default;
  /// For reports: "ssd".
  virtual std::string name() const = 0;
  virtual const Raster<Dim>& fixed_raster() const = 0;
  /// Sweeps over the samples per evaluation: 2 where a sum over all of them comes first.
  virtual int num_passes() const { return 1; }
  virtual std::unique_ptr<Sums> new_sums() const { return std::make_unique<Sums>(); }
  /// Adds what a row contributes to the pass to `sums`; the last pass writes the row's forces.
  virtual void evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                            Sums& sums) const = 0;
  /// After the last pass: the energy E. @throws SolverError when fewer than a quarter of the samples
  /// fall inside the moving image.
  virtual double finish_pass(int pass, std::span<const std::unique_ptr<Sums>> tiles) = 0;

  /// The same value in double precision, one sample at a time: the reference for tests and for few
  /// samples.
  /// @param mapped  T(x), mm, for every sample of the fixed raster, in its order.
  /// @param forces  dE/dT(x) per sample, overwritten; empty: not wanted.
  virtual double evaluate(std::span<const Point<Dim>> mapped,
                          std::span<Vector<Dim>> forces) const = 0;
};

}  // namespace crease
