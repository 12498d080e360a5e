#pragma once

#include <span>

#include "Transforms/Splines/DeterminantPieces.h"
#include "Transforms/Splines/PowellSabinPatch.h"

namespace crease {

/// det grad T of a Powell-Sabin map on its small triangles: quadratic, for grad T is linear there. The rough
/// bound is the least coefficient of the six, which are cheap.
class PowellSabinPieces final : public DeterminantPieces<2> {
 public:
  /// All arguments must outlive this.
  PowellSabinPieces(std::span<const PowellSabinPatch> patches, const ControlPoints<2>& phi,
                    const Matrix<2>& linear)
      : patches_(patches), phi_(phi), linear_(linear) {}

  int num_patches() const override { return static_cast<int>(patches_.size()); }
  double rough_bound(int patch) const override;
  std::vector<DeterminantPiece<2>> pieces(int patch) const override;

 private:
  SimplexPiece<2> piece(const PowellSabinPatch& patch, int cell) const;

  std::span<const PowellSabinPatch> patches_;
  const ControlPoints<2>& phi_;
  Matrix<2> linear_;
};

}  // namespace crease
