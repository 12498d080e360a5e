#pragma once

namespace crease {

/// The gradients of a cell's k functions at its q points, and what the elastic law says there. Arrays over
/// points have `stride` numbers per component (a multiple of 4, q or more; the rest repeats the last
/// point with weight 0), arrays over functions `width` (a multiple of 4, k or more; the rest is zero).
struct ElasticCell {
  int num_points, stride;
  int num_functions, width;
  const double* gradients;  ///< `width` per column, column s q + p: d/dx_s at point p
  const double* phi;        ///< Dim rows of `width` control values
  const double* linear;     ///< of the affine part, row by row

  const double* weight;  ///< per point
  const double *lambda, *mu;
  bool neo_hookean;
  bool mean_dilatation;     ///< lambda enters through the slope alone
  double dilatation_slope;  ///< d(energy density) / d(dilatation), of the patch

  double* deformation;  ///< F_as, component Dim a + s
  double* determinant;  ///< per point
  double* energy;       ///< per point, times the weight
  double* stress;       ///< P_as, times the weight
  /// dP_as/dF_bt times the weight: Dim Dim components (s, t) for each pair a <= b; null: not wanted.
  double* tangent;
  double* pivot;     ///< least pivot of the tangent over its trace: negative where it is not convex
  double* products;  ///< scratch, as large as the gradients
};

#define CREASE_ELASTIC_KERNELS                                                                            \
  /* Fills deformation and determinant. */                                                                \
  void elastic_deformation_2(const ElasticCell& cell);                                                    \
  void elastic_deformation_3(const ElasticCell& cell);                                                    \
  /* Fills energy with the dilatation (tr E or det F), stress with its derivative by F, both weighted. */ \
  void elastic_dilatation_2(const ElasticCell& cell);                                                     \
  void elastic_dilatation_3(const ElasticCell& cell);                                                     \
  /* Fills energy, stress, and where wanted tangent and pivot. */                                         \
  void elastic_stress_2(const ElasticCell& cell);                                                         \
  void elastic_stress_3(const ElasticCell& cell);                                                         \
  /* forces, Dim rows of `width`: += sum over points of stress_as dB_i/dx_s. */                           \
  void elastic_forces_2(const ElasticCell& cell, double* forces);                                         \
  void elastic_forces_3(const ElasticCell& cell, double* forces);                                         \
  /* hessian, a width x width matrix by rows for each pair a <= b: sum over points of */                  \
  /* dB_i/dx_s tangent dB_k/dx_t; for a = b only k <= i is of use. */                                     \
  void elastic_hessian_2(const ElasticCell& cell, double* hessian);                                       \
  void elastic_hessian_3(const ElasticCell& cell, double* hessian);

namespace baseline {
CREASE_ELASTIC_KERNELS
}
namespace avx2 {
CREASE_ELASTIC_KERNELS
}
#undef CREASE_ELASTIC_KERNELS

}  // namespace crease
