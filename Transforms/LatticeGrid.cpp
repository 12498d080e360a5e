#include "Transforms/LatticeGrid.h"

#include "Core/Error.h"

namespace crease {
namespace {

constexpr double kMostBytes = 4e9;

template <int Dim>
QuasiInterpolation<Dim> affordable(const Raster<Dim>& raster, double span, int num_functions) {
  QuasiInterpolation<Dim> interpolation(raster, span);
  const double bytes = 8.0 * num_functions * static_cast<double>(interpolation.nodes().cols());
  if (bytes > kMostBytes) {
    throw InvalidInput(message("LatticeGrid: ", num_functions, " functions at ",
                               interpolation.nodes().cols(), " lattice points would need ",
                               bytes / 1e9, " GB; at most ", kMostBytes / 1e9,
                               " GB are possible: choose fewer centres, farther apart."));
  }
  return interpolation;
}

}  // namespace

template <int Dim>
LatticeGrid<Dim>::LatticeGrid(const Functions& functions, int num_functions,
                              const Raster<Dim>& raster, double span, double step)
    : curvature_points_(raster, step) {
  const QuasiInterpolation<Dim> interpolation = affordable(raster, span, num_functions);
  to_lattice_ = interpolation.control_points(functions(interpolation.nodes()));
  at_points_ = functions(curvature_points_.points());
  lattice_ = interpolation.basis().bind(raster);
}

template <int Dim>
std::unique_ptr<typename LatticeGrid<Dim>::Coefficients> LatticeGrid<Dim>::prepare(
    const Eigen::Ref<const ControlPoints<Dim>>& control_points) const {
  return lattice_->prepare(ControlPoints<Dim>(control_points * to_lattice_));
}

template <int Dim>
void LatticeGrid<Dim>::finish(std::span<const std::unique_ptr<Accumulator>> sums,
                              Eigen::Ref<ControlPoints<Dim>> gradient) const {
  ControlPoints<Dim> on_lattice = ControlPoints<Dim>::Zero(Dim, to_lattice_.cols());
  lattice_->finish(sums, on_lattice);
  gradient += on_lattice * to_lattice_.transpose();
}

template <int Dim>
void LatticeGrid<Dim>::add_curvature(const CurvatureBlocks<Dim>& blocks, double scale,
                                     BlockHessian<Dim>& hessian) const {
  add_dense_curvature<Dim>(curvature_points_, at_points_, blocks, scale, hessian);
}

template class LatticeGrid<2>;
template class LatticeGrid<3>;

}  // namespace crease
