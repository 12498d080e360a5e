#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "Core/Parallel.h"
#include "Transforms/BlockHessian.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

/// The gradients of the functions at the quadrature points of one element: all that an energy of grad T
/// needs to know of a basis.
template <int Dim>
struct GradientCell {
  std::vector<int> positions;  ///< of its k control points among the patch's, ascending
  /// k x (Dim q): d/dx_0 at all q points, d/dx_1, ..; equal cells (lattices, congruent triangles) share it.
  std::shared_ptr<const Eigen::MatrixXd> gradients;
  Eigen::VectorXd weights;  ///< q: of the quadrature, times that of the energy; none is 0
  Eigen::Matrix<double, Dim, Eigen::Dynamic> points;  ///< Dim x q, mm; empty unless asked for
};

/// The cells of a triangle or knot span.
template <int Dim>
struct GradientPatch {
  std::vector<int> control_points;  ///< of any of its cells, ascending
  std::vector<GradientCell<Dim>> cells;
  int region = -1;  ///< of the basis
  int patch = -1;
};

/// Gives for an element what each of its points weighs (1 at the call); 0: the point is left out.
template <int Dim>
using PointWeights =
    std::function<void(const QuadratureElement<Dim>& element, Eigen::VectorXd& weights)>;

/// All cells with weight, patch by patch in the order of the basis' quadrature.
/// @param wanted   patches that may carry weight; null: all.
/// @param weights  null: 1 everywhere.
template <int Dim>
std::vector<GradientPatch<Dim>> gradient_patches(
    const SplineBasis<Dim>& basis, int quadrature_degree,
    const std::function<bool(int region, int patch)>& wanted, const PointWeights<Dim>& weights,
    bool keep_points = false);

/// The same of elements of another quadrature, patch by patch.
template <int Dim>
std::vector<GradientPatch<Dim>> gradient_patches(
    const std::vector<QuadratureElement<Dim>>& elements, bool keep_points);

/// What one patch adds to an energy and its derivatives, by its own control points.
template <int Dim>
struct PatchSums {
  double energy = 0;
  ControlPoints<Dim> gradient;  ///< Dim x m; empty: not wanted
  Eigen::MatrixXd hessian;      ///< (Dim m)^2, lower triangle; empty: not wanted

  void resize(const GradientPatch<Dim>& patch, bool with_gradient, bool with_hessian);
};

/// Adds a patch's sums, times `scale`, to those of all control points.
template <int Dim>
void add_gradient(const GradientPatch<Dim>& patch, const PatchSums<Dim>& sums, double scale,
                  ControlPoints<Dim>& gradient);
template <int Dim>
void add_hessian(const GradientPatch<Dim>& patch, const PatchSums<Dim>& sums, double scale,
                 BlockHessian<Dim>& hessian);

/// Evaluates patches in parallel, some at a time so that few sums wait, and adds them in order: the same
/// bits on any number of threads.
/// @param evaluate  evaluate(p) returns the sums of patch p; called from several threads.
/// @param add       add(p, sums) for p = 0, 1, ..
template <typename Evaluate, typename Add>
void add_in_order(std::int64_t count, const Evaluate& evaluate, const Add& add) {
  constexpr std::int64_t kChunk = 128;
  std::vector<decltype(evaluate(count))> sums;
  for (std::int64_t begin = 0; begin < count; begin += kChunk) {
    sums.clear();
    sums.resize(static_cast<std::size_t>(std::min(kChunk, count - begin)));
    parallel_for(std::ssize(sums),
                 [&](std::int64_t n) { sums[static_cast<std::size_t>(n)] = evaluate(begin + n); });
    for (std::int64_t n = 0; n < std::ssize(sums); ++n) {
      add(begin + n, sums[static_cast<std::size_t>(n)]);
    }
  }
}

}  // namespace crease
