#pragma once

#include <span>
#include <vector>

#include "Transforms/Domains/KnotNet.h"

namespace crease {

/// Triangles whose neighbourhoods (all triangles that share a vertex with them, with their clouds) are
/// translates of each other: on structured meshes most are of a few kinds, and what holds for one of a
/// kind, its cells and their integrals, holds for all.
class KnotCongruence {
 public:
  explicit KnotCongruence(const KnotNet<2>& net);

  /// The lowest triangle of the kind; the triangle itself when no lower one is congruent.
  int representative(int triangle) const { return representative_[triangle]; }
  /// The triangle's neighbours, itself included, in an order that is the same for all of a kind.
  std::span<const int> neighbours(int triangle) const { return neighbours_[triangle]; }

 private:
  std::vector<int> representative_;
  std::vector<std::vector<int>> neighbours_;
};

}  // namespace crease
