#include "Transforms/TransformLattice.h"

#include "Core/Parallel.h"

namespace crease {
namespace {

constexpr std::int64_t kTile = 64;  // nodes

}  // namespace

template <int Dim>
TransformLattice<Dim>::TransformLattice(const Raster<Dim>& raster, double span)
    : interpolation_(raster, span), grid_(interpolation_.basis().bind(raster)) {
  for (Eigen::Index n = 0; n < interpolation_.nodes().cols(); ++n) {
    nodes_.push_back(interpolation_.nodes().col(n));
  }
}

template <int Dim>
ControlPoints<Dim> TransformLattice<Dim>::control_points(const Transform<Dim>& transform,
                                                         const AffineMap<Dim>& affine) const {
  const std::int64_t count = std::ssize(nodes_);
  Eigen::MatrixXd values(Dim, count);
  parallel_for((count + kTile - 1) / kTile, [&](std::int64_t tile) {
    for (std::int64_t n = tile * kTile; n < std::min(count, (tile + 1) * kTile); ++n) {
      const Point<Dim>& x = nodes_[static_cast<std::size_t>(n)];
      values.col(n) = transform.map(x) - affine(x);
    }
  });
  return interpolation_.control_points(values);
}

template <int Dim>
void TransformLattice<Dim>::add_adjoint(const Transform<Dim>& transform,
                                        const ControlPoints<Dim>& by_control_points,
                                        Eigen::Ref<Eigen::VectorXd> gradient) const {
  const Eigen::MatrixXd by_nodes = interpolation_.adjoint(by_control_points);
  std::vector<Vector<Dim>> forces(nodes_.size());
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    forces[n] = by_nodes.col(static_cast<Eigen::Index>(n));
  }
  transform.add_adjoint(nodes_, forces, gradient);
}

template class TransformLattice<2>;
template class TransformLattice<3>;

}  // namespace crease
