#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
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
  /// The pass whose finish_pass() knows the value; forces may need later ones.
  virtual int value_pass() const { return num_passes() - 1; }
  /// Whether a pass looks at the mapped points; other passes use what an earlier one has kept, and their
  /// rows have no displacement.
  virtual bool needs_map(int) const { return true; }
  virtual std::unique_ptr<Sums> new_sums() const { return std::make_unique<Sums>(); }
  /// Adds what a row contributes to the pass to `sums`; the last pass writes the row's forces.
  virtual void evaluate_row(int pass, const MappedRow<Dim>& row, const ForceRow<Dim>& out,
                            Sums& sums) const = 0;
  /// From value_pass() on: the energy E. @throws SolverError when fewer than a quarter of the samples
  /// fall inside the moving image.
  virtual double finish_pass(int pass, std::span<const std::unique_ptr<Sums>> tiles) = 0;

  /// What 1 of the value is worth in half the integral of squared differences of normalised intensities,
  /// mm^Dim: times this, values of all metrics go with the same weights of energies.
  virtual double unit() const { return 1; }
  /// Power of the noise that the value, times unit(), is relative to; nullopt: the value is a residual's
  /// own power.
  virtual std::optional<double> noise_power() const { return std::nullopt; }
  /// Whether tissue may be expected to look alike in both images, so that optical flow is worth a try.
  virtual bool expects_similar_intensities() const { return false; }

  /// The same value in double precision, one sample at a time: the reference for tests and for few
  /// samples.
  /// @param mapped  T(x), mm, for every sample of the fixed raster, in its order.
  /// @param forces  dE/dT(x) per sample, overwritten; empty: not wanted.
  virtual double evaluate(std::span<const Point<Dim>> mapped,
                          std::span<Vector<Dim>> forces) const = 0;
};

}  // namespace crease
