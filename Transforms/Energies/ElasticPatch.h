#pragma once

#include <vector>

#include "Transforms/Energies/ElasticMaterial.h"
#include "Transforms/Energies/GradientCells.h"

namespace crease {

/// Which second derivative an elastic energy gives.
enum class ElasticTangent {
  /// The exact one where it is positive semi-definite, else its positive semi-definite part, point by point.
  kSemidefinite,
  kExact
};

/// The smallest det F over quadrature points: negative where a map folds.
template <int Dim>
struct LeastDeterminant {
  double value = 1;
  Point<Dim> place = Point<Dim>::Zero();  ///< mm
  int region = -1;                        ///< of the patch
};

/// A patch and what it is made of.
template <int Dim>
struct ElasticPatch {
  /// Tables of gradients with rows of zeros at their end, so that these are a multiple of 4.
  GradientPatch<Dim> cells;
  /// Per cell: one entry for all of its points, or one each.
  std::vector<std::vector<LameParameters>> lame;
  double measure = 0;      ///< area or volume
  double mean_lambda = 0;  ///< over the patch
};

/// Stored energy of a patch, with its derivatives by the patch's control points, and the least determinant.
template <int Dim>
struct ElasticSums : PatchSums<Dim> {
  LeastDeterminant<Dim> least;
};

/// @param phi  of the patch's own control points, Dim x m.
template <int Dim>
ElasticSums<Dim> evaluate_elastic_patch(const ElasticPatch<Dim>& patch,
                                        const ElasticMaterial& material, const Matrix<Dim>& linear,
                                        const ControlPoints<Dim>& phi, bool with_gradient,
                                        bool with_hessian, ElasticTangent tangent);

extern template ElasticSums<2> evaluate_elastic_patch<2>(const ElasticPatch<2>&,
                                                         const ElasticMaterial&, const Matrix<2>&,
                                                         const ControlPoints<2>&, bool, bool,
                                                         ElasticTangent);
extern template ElasticSums<3> evaluate_elastic_patch<3>(const ElasticPatch<3>&,
                                                         const ElasticMaterial&, const Matrix<3>&,
                                                         const ControlPoints<3>&, bool, bool,
                                                         ElasticTangent);

}  // namespace crease
