#include "Transforms/Splines/PowellSabinPieces.h"

#include <algorithm>

#include "Transforms/Splines/BPatchIndices.h"

namespace crease {
namespace {

/// Of a gradient, relative to the largest term of its sum: ordinates are means of means of a dozen products.
constexpr double kGradientAccuracy = 256 * std::numeric_limits<double>::epsilon();

}  // namespace

SimplexPiece<2> PowellSabinPieces::piece(const PowellSabinPatch& patch, int cell) const {
  const auto corners = patch.cell(cell);
  const auto found = patch.control_points();
  const Vector<2> origin = phi_.col(found[0]);  // gradients sum to 0
  std::array<Matrix<2>, 3> jacobians;
  double error = 0;
  int n = 0;
  for (const auto& index : multi_indices<2>(1)) {
    const auto corner = std::ranges::find(index, 1) - index.begin();
    const auto values = patch.evaluate(cell, corners[static_cast<std::size_t>(corner)], 1);
    Matrix<2>& jacobian = jacobians[static_cast<std::size_t>(n++)];
    jacobian = linear_;
    double terms = linear_.cwiseAbs().maxCoeff();
    for (Eigen::Index f = 0; f < values.rows(); ++f) {
      const Vector<2> c = phi_.col(found[static_cast<std::size_t>(f)]) - origin;
      jacobian += c * values.row(f).segment<2>(1);
      terms += c.cwiseAbs().maxCoeff() * values.row(f).segment<2>(1).cwiseAbs().maxCoeff();
    }
    error = std::max(error, kGradientAccuracy * terms);
  }
  return simplex_piece<2>(corners, 1, jacobians, error);
}

double PowellSabinPieces::rough_bound(int patch) const {
  double least = std::numeric_limits<double>::infinity();
  for (int cell = 0; cell < PowellSabinPatch::kNumCells; ++cell) {
    const SimplexPiece<2> found = piece(patches_[static_cast<std::size_t>(patch)], cell);
    least = std::min(least, found.determinant.coefficients().minCoeff() - found.error);
  }
  return least;
}

std::vector<DeterminantPiece<2>> PowellSabinPieces::pieces(int patch) const {
  std::vector<DeterminantPiece<2>> all;
  for (int cell = 0; cell < PowellSabinPatch::kNumCells; ++cell) {
    all.emplace_back(piece(patches_[static_cast<std::size_t>(patch)], cell));
  }
  return all;
}

}  // namespace crease
