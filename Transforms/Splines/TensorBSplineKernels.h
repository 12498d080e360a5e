#pragma once

namespace crease {

/// Samples begin .. end - 1 of a row lie in knot span `span` of the first axis.
struct TensorRun {
  int begin;
  int end;
  int span;
};

/// How the rows of a raster lie in the first axis of a tensor-product spline.
struct TensorRowPlan {
  int degree;
  int net_size;           ///< functions along the first axis
  const TensorRun* runs;  ///< from left to right
  int num_runs;
  const float* local;  ///< per sample s - 1/2, s in [0, 1] within its span; 8 entries of padding
  const double* polynomials;  ///< [power of s - 1/2][function of the span], (degree + 1)^2
  int polynomials_per_span;   ///< step from span to span in `polynomials`; 0: all spans are alike
};

// A row's control points along the first axis are weighted sums of `num_rows` rows of the net (the
// functions of the other axes that do not vanish there). `sums`: net_size doubles of scratch.
#define CREASE_TENSOR_KERNELS                                                                        \
  /* out[i] = sum_j weights[j] sum_x rows[j][x] B_x(sample i); may write 7 entries after the row. */ \
  void tensor_map_row(const TensorRowPlan& plan, const double* const* rows, const double* weights,   \
                      int num_rows, double* sums, float* out);                                       \
  /* rows[j][x] += weights[j] sum_i force[i] B_x(sample i); reads, but ignores, 7 entries after. */  \
  void tensor_adjoint_row(const TensorRowPlan& plan, const float* force, double* const* rows,        \
                          const double* weights, int num_rows, double* sums);

namespace baseline {
CREASE_TENSOR_KERNELS
}
namespace avx2 {
CREASE_TENSOR_KERNELS
}
#undef CREASE_TENSOR_KERNELS

}  // namespace crease
