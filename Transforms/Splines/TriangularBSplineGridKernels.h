#pragma once

namespace crease {

/// A run of samples of a row: in the core of a triangle, in a strip, or outside the domain.
struct GridRun {
  enum Kind : int { kOutside = -2, kStrip = -1 };  // else the triangle of a core

  int first;  ///< sample
  int count;  ///< strips: at most 16
  int kind;
  int num_points;           ///< strips: control points,
  long long points_start;   ///< where their numbers start,
  long long weights_start;  ///< and their weights [control point][sample]
};

/// Local coordinates of a triangle's core polynomial: X = (i - centre_i) / size, Y = (j - centre_j) / size.
struct GridPatch {
  double centre_i, centre_j, inverse_size;
};

/// Floats or doubles per power of Y of a core polynomial of two components: x: X^0..X^n, y: X^0..X^n, padding.
constexpr int core_stride(int degree) { return 2 * (degree + 1) <= 8 ? 8 : 16; }

struct GridRow {
  const GridRun* runs;
  int num_runs;
  int row;
  int degree;
  const GridPatch* patches;
  const int* points;
  const float* weights;  // 16 more behind the last
};

#define CREASE_GRID_KERNELS                                                                            \
  /* core: (degree + 1) core_stride floats per triangle; points: x, y per control point. Writes */     \
  /* up to 15 entries beyond a run; runs are in ascending order.                                */     \
  void grid_map_row(const GridRow& row, const float* core, const float* points, float* out_x,          \
                    float* out_y);                                                                     \
  /* moments + patch_slot[t] (degree + 1) core_stride: of triangle t; sums + 16 point_slot[c]:  */     \
  /* of control point c, 8 partial sums of x and 8 of y.                                        */     \
  void grid_adjoint_row(const GridRow& row, const float* force_x, const float* force_y,                \
                        const int* patch_slot, double* moments, const int* point_slot,                 \
                        float* sums);                                                                  \
  /* sums[i][c][k] += sum over blocks G_c w_i w_k, k <= i, c = xx, xy, yy; rows of `stride` weights */ \
  /* (a multiple of 8), the first `size` of them used.                                           */    \
  void grid_block_products(const float* weights, const int* blocks, int num_blocks, int size,          \
                           int stride, const float* xx, const float* xy, const float* yy,              \
                           float* sums);

namespace baseline {
CREASE_GRID_KERNELS
}
namespace avx2 {
CREASE_GRID_KERNELS
}
#undef CREASE_GRID_KERNELS

}  // namespace crease
