#include "Transforms/Splines/TriangularBSplineGridKernels.h"

namespace crease::CREASE_ISA {
namespace {

using Float8 = float __attribute__((vector_size(32)));
using Float8Unaligned = float __attribute__((vector_size(32), aligned(4)));
using Int8 = int __attribute__((vector_size(32)));
using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));
using Double4Unaligned = double __attribute__((vector_size(32), aligned(8)));

inline Float8 load(const float* p) { return *reinterpret_cast<const Float8Unaligned*>(p); }
inline void store(float* p, Float8 v) { *reinterpret_cast<Float8Unaligned*>(p) = v; }
inline Double4 load(const double* p) { return *reinterpret_cast<const Double4Unaligned*>(p); }
inline void store(double* p, Double4 v) { *reinterpret_cast<Double4Unaligned*>(p) = v; }
inline Float8 splat(float v) { return Float8{v, v, v, v, v, v, v, v}; }
constexpr Float8 kLanes = {0, 1, 2, 3, 4, 5, 6, 7};
constexpr Int8 kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7};

// The first `count` lanes of v, the others 0 (whatever they were).
inline Float8 first_lanes(Float8 v, int count) {
  const Int8 keep = kLaneNumbers < count;
  return reinterpret_cast<Float8>(reinterpret_cast<Int8>(v) & keep);
}

inline Double4 low(Float8 v) {
  return __builtin_convertvector(__builtin_shufflevector(v, v, 0, 1, 2, 3), Double4);
}
inline Double4 high(Float8 v) {
  return __builtin_convertvector(__builtin_shufflevector(v, v, 4, 5, 6, 7), Double4);
}

// Sums of neighbouring lanes: a01 a23 b01 b23 of the lower halves, then of the upper ones.
inline Float8 add_pairs(Float8 a, Float8 b) {
  return __builtin_shufflevector(a, b, 0, 2, 8, 10, 4, 6, 12, 14) +
         __builtin_shufflevector(a, b, 1, 3, 9, 11, 5, 7, 13, 15);
}

// Lane k of the result is the sum of all lanes of v[k].
inline Float8 sum_lanes(const Float8* v) {
  const Float8 a = add_pairs(add_pairs(v[0], v[1]), add_pairs(v[2], v[3]));
  const Float8 b = add_pairs(add_pairs(v[4], v[5]), add_pairs(v[6], v[7]));
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}

// X of sample `first` and the step of X per sample.
struct LocalRun {
  float x, step, y;
  LocalRun(const GridPatch& patch, int first, int row)
      : x(static_cast<float>((first - patch.centre_i) * patch.inverse_size)),
        step(static_cast<float>(patch.inverse_size)),
        y(static_cast<float>((row - patch.centre_j) * patch.inverse_size)) {}
};

template <int Degree>
void map_core(const GridRow& row, const GridRun& run, const float* core, float* out_x,
              float* out_y) {
  constexpr int kStride = core_stride(Degree);
  const LocalRun local(row.patches[run.kind], run.first, row.row);
  // Collapse the polynomial in X and Y to one in X on this row.
  const float* c = core + static_cast<long long>(run.kind) * (Degree + 1) * kStride;
  float p[kStride];
  for (int part = 0; part < kStride; part += 8) {
    Float8 sum = load(c + Degree * kStride + part);
    for (int j = Degree - 1; j >= 0; --j) sum = sum * local.y + load(c + j * kStride + part);
    store(p + part, sum);
  }
  Float8 coefficient_x[Degree + 1], coefficient_y[Degree + 1];
  for (int k = 0; k <= Degree; ++k) {
    coefficient_x[k] = splat(p[k]);
    coefficient_y[k] = splat(p[Degree + 1 + k]);
  }
  Float8 x = local.x + kLanes * local.step;
  const Float8 advance = splat(8.0f * local.step);
  float* to_x = out_x + run.first;
  float* to_y = out_y + run.first;
  for (int i = 0; i < run.count; i += 8, x += advance) {
    Float8 ux = coefficient_x[Degree], uy = coefficient_y[Degree];
    for (int k = Degree - 1; k >= 0; --k) {
      ux = ux * x + coefficient_x[k];
      uy = uy * x + coefficient_y[k];
    }
    store(to_x + i, ux);
    store(to_y + i, uy);
  }
}

// Registers of 8 samples: 1 or 2.
template <int R>
void map_strip(const GridRow& row, const GridRun& run, const float* points, float* out_x,
               float* out_y) {
  const int* numbers = row.points + run.points_start;
  const float* weights = row.weights + run.weights_start;
  Float8 ux[R] = {}, uy[R] = {};
  for (int k = 0; k < run.num_points; ++k, weights += run.count) {
    const float* p = points + 2 * numbers[k];
    for (int r = 0; r < R; ++r) {
      const Float8 w = load(weights + 8 * r);
      ux[r] += w * p[0];
      uy[r] += w * p[1];
    }
  }
  for (int r = 0; r < R; ++r) {
    store(out_x + run.first + 8 * r, ux[r]);
    store(out_y + run.first + 8 * r, uy[r]);
  }
}

void map_outside(const GridRun& run, float* out_x, float* out_y) {
  for (int i = 0; i < run.count; i += 8) {
    store(out_x + run.first + i, Float8{});
    store(out_y + run.first + i, Float8{});
  }
}

template <int Degree>
void map_row(const GridRow& row, const float* core, const float* points, float* out_x,
             float* out_y) {
  for (int i = 0; i < row.num_runs; ++i) {
    const GridRun& run = row.runs[i];
    if (run.kind >= 0) {
      map_core<Degree>(row, run, core, out_x, out_y);
    } else if (run.kind == GridRun::kOutside) {
      map_outside(run, out_x, out_y);
    } else if (run.count <= 8) {
      map_strip<1>(row, run, points, out_x, out_y);
    } else {
      map_strip<2>(row, run, points, out_x, out_y);
    }
  }
}

template <int Degree>
void adjoint_core(const GridRow& row, const GridRun& run, const float* force_x,
                  const float* force_y, double* moments) {
  constexpr int kStride = core_stride(Degree);
  const LocalRun local(row.patches[run.kind], run.first, row.row);
  Float8 sums[kStride] = {};  // x: X^0..X^n, y: X^0..X^n
  Float8 x = local.x + kLanes * local.step;
  const Float8 advance = splat(8.0f * local.step);
  const float* from_x = force_x + run.first;
  const float* from_y = force_y + run.first;
  const auto add = [&](Float8 fx, Float8 fy) {
    for (int k = 0; k <= Degree; ++k) {
      sums[k] += fx;
      sums[Degree + 1 + k] += fy;
      fx *= x;
      fy *= x;
    }
  };
  int i = 0;
  for (; i + 8 <= run.count; i += 8, x += advance) add(load(from_x + i), load(from_y + i));
  if (i < run.count) {
    add(first_lanes(load(from_x + i), run.count - i), first_lanes(load(from_y + i), run.count - i));
  }
  for (int part = 0; part < kStride; part += 8) {
    const Float8 total = sum_lanes(sums + part);
    Double4 lower = low(total), upper = high(total);
    double* target = moments + part;
    for (int j = 0; j <= Degree; ++j, target += kStride) {
      store(target, load(target) + lower);
      store(target + 4, load(target + 4) + upper);
      lower *= static_cast<double>(local.y);
      upper *= static_cast<double>(local.y);
    }
  }
}

// Every control point keeps eight partial sums per component: nothing is summed across lanes here.
template <int R>
void adjoint_strip(const GridRow& row, const GridRun& run, const float* force_x,
                   const float* force_y, const int* slot, float* sums) {
  const int* numbers = row.points + run.points_start;
  const float* weights = row.weights + run.weights_start;
  Float8 fx[R], fy[R];
  for (int r = 0; r < R; ++r) {
    fx[r] = first_lanes(load(force_x + run.first + 8 * r), run.count - 8 * r);
    fy[r] = first_lanes(load(force_y + run.first + 8 * r), run.count - 8 * r);
  }
  for (int k = 0; k < run.num_points; ++k, weights += run.count) {
    float* target = sums + 16 * static_cast<long long>(slot[numbers[k]]);
    Float8 x = load(target), y = load(target + 8);
    for (int r = 0; r < R; ++r) {
      const Float8 w = load(weights + 8 * r);
      x += w * fx[r];
      y += w * fy[r];
    }
    store(target, x);
    store(target + 8, y);
  }
}

template <int Degree>
void adjoint_row(const GridRow& row, const float* force_x, const float* force_y,
                 const int* patch_slot, double* moments, const int* point_slot, float* sums) {
  constexpr int kPerTriangle = (Degree + 1) * core_stride(Degree);
  for (int i = 0; i < row.num_runs; ++i) {
    const GridRun& run = row.runs[i];
    if (run.kind >= 0) {
      adjoint_core<Degree>(row, run, force_x, force_y,
                           moments + static_cast<long long>(patch_slot[run.kind]) * kPerTriangle);
    } else if (run.kind == GridRun::kStrip) {
      if (run.count <= 8) {
        adjoint_strip<1>(row, run, force_x, force_y, point_slot, sums);
      } else {
        adjoint_strip<2>(row, run, force_x, force_y, point_slot, sums);
      }
    }
  }
}

constexpr int kBlocksAtOnce = 64;  // rows of weights that stay in the first cache

// Rows i = first .. first + 7 of the sums, columns up to 8 Registers, from some blocks.
template <int Registers>
void add_products(const float* weights, int num_blocks, int first, int last, int stride,
                  const float (*g)[kBlocksAtOnce], float* sums) {
  for (int i = first; i < last; ++i) {
    Float8 total[3][Registers] = {};
    const float* row = weights;
    for (int b = 0; b < num_blocks; ++b, row += stride) {
      const Float8 wxx = splat(row[i] * g[0][b]), wxy = splat(row[i] * g[1][b]),
                   wyy = splat(row[i] * g[2][b]);
      for (int r = 0; r < Registers; ++r) {
        const Float8 w = load(row + 8 * r);
        total[0][r] += wxx * w;
        total[1][r] += wxy * w;
        total[2][r] += wyy * w;
      }
    }
    for (int c = 0; c < 3; ++c) {
      float* target = sums + (3 * i + c) * stride;
      for (int r = 0; r < Registers; ++r) store(target + 8 * r, load(target + 8 * r) + total[c][r]);
    }
  }
}

// One row of the sums, any number of columns.
void add_wide_products(const float* weights, int num_blocks, int i, int columns, int stride,
                       const float (*g)[kBlocksAtOnce], float* sums) {
  for (int b = 0; b < num_blocks; ++b, weights += stride) {
    if (weights[i] == 0.0f) continue;
    for (int c = 0; c < 3; ++c) {
      const Float8 factor = splat(weights[i] * g[c][b]);
      float* target = sums + (3 * i + c) * stride;
      for (int k = 0; k < columns; k += 8) {
        store(target + k, load(target + k) + factor * load(weights + k));
      }
    }
  }
}

}  // namespace

void grid_map_row(const GridRow& row, const float* core, const float* points, float* out_x,
                  float* out_y) {
  switch (row.degree) {
    case 1:
      return map_row<1>(row, core, points, out_x, out_y);
    case 2:
      return map_row<2>(row, core, points, out_x, out_y);
    case 3:
      return map_row<3>(row, core, points, out_x, out_y);
    case 4:
      return map_row<4>(row, core, points, out_x, out_y);
    default:
      return map_row<5>(row, core, points, out_x, out_y);
  }
}

void grid_adjoint_row(const GridRow& row, const float* force_x, const float* force_y,
                      const int* patch_slot, double* moments, const int* point_slot, float* sums) {
  switch (row.degree) {
    case 1:
      return adjoint_row<1>(row, force_x, force_y, patch_slot, moments, point_slot, sums);
    case 2:
      return adjoint_row<2>(row, force_x, force_y, patch_slot, moments, point_slot, sums);
    case 3:
      return adjoint_row<3>(row, force_x, force_y, patch_slot, moments, point_slot, sums);
    case 4:
      return adjoint_row<4>(row, force_x, force_y, patch_slot, moments, point_slot, sums);
    default:
      return adjoint_row<5>(row, force_x, force_y, patch_slot, moments, point_slot, sums);
  }
}

void grid_block_products(const float* weights, const int* blocks, int num_blocks, int size,
                         int stride, const float* xx, const float* xy, const float* yy,
                         float* sums) {
  float g[3][kBlocksAtOnce];
  for (int start = 0; start < num_blocks; start += kBlocksAtOnce) {
    const int count = num_blocks - start < kBlocksAtOnce ? num_blocks - start : kBlocksAtOnce;
    for (int b = 0; b < count; ++b) {
      g[0][b] = xx[blocks[start + b]];
      g[1][b] = xy[blocks[start + b]];
      g[2][b] = yy[blocks[start + b]];
    }
    const float* rows = weights + static_cast<long long>(start) * stride;
    for (int first = 0; first < size; first += 8) {
      const int last = size < first + 8 ? size : first + 8;
      switch (first / 8) {
        case 0:
          add_products<1>(rows, count, first, last, stride, g, sums);
          break;
        case 1:
          add_products<2>(rows, count, first, last, stride, g, sums);
          break;
        case 2:
          add_products<3>(rows, count, first, last, stride, g, sums);
          break;
        case 3:
          add_products<4>(rows, count, first, last, stride, g, sums);
          break;
        default:
          for (int i = first; i < last; ++i) {
            add_wide_products(rows, count, i, first + 8, stride, g, sums);
          }
      }
    }
  }
}

}  // namespace crease::CREASE_ISA
