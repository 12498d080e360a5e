#include "Images/InterpolationKernel.h"

#include "Images/InterpolationLanes.h"

namespace crease::CREASE_ISA {
namespace {

/// Where the samples of one register lie: pixel `base + offset[lane]`, and beyond it by `fraction`.
template <int Dim>
struct Position {
  const float* base;
  int offset[kLanes];
  Floats fraction[Dim];  ///< in [0, 1]
  Ints inside;           ///< -1 or 0
  Ints free[Dim];        ///< -1 where the index was not clamped, else 0
  Floats poison;         ///< 0, or NaN for points that are not finite
};

/// What is the same for all samples of a row.
template <int Dim>
struct RowConstants {
  explicit RowConstants(const InterpolationRow& row) {
    for (int a = 0; a < Dim; ++a) {
      for (int l = 0; l < kLanes; ++l) lane_step[a][l] = static_cast<float>(l * row.step[a]);
    }
  }
  Floats lane_step[Dim];
};

/// The whole pixel of the register's first sample and the rest, in double precision; only the small
/// rest and the displacement are added in single precision. So images of any width are sampled alike.
/// @tparam Last  the largest whole pixel wanted per axis is size - Last.
template <int Last, int Dim>
inline Position<Dim> locate(const InterpolationRow& row, const RowConstants<Dim>& constants, int i,
                            const float* const (&displacement)[3]) {
  Floats u[Dim];
  for (int a = 0; a < Dim; ++a)
    u[a] = displacement[a] != nullptr ? load(displacement[a]) : Floats{};
  Position<Dim> p;
  p.base = row.pixels;
  p.inside = ~Ints{};
  p.poison = Floats{};
  Ints offset = {};
  for (int a = 0; a < Dim; ++a) {
    const double index = row.start[a] + i * row.step[a];
    const int top = row.size[a] - 1;
    const int whole = index > 0 ? (index < top ? static_cast<int>(index) : top) : 0;
    Floats t = constants.lane_step[a] + static_cast<float>(index - whole);
    for (int b = 0; b < Dim; ++b) t += row.to_index[a][b] * u[b];
    const float lower = static_cast<float>(-whole), upper = static_cast<float>(top - whole);
    p.inside &= (t >= lower - 0.5f) & (t <= upper + 0.5f);
    p.free[a] = (t > lower) & (t < upper);
    p.poison += t - t;
    t = t > lower ? t : all(lower);
    t = t < upper ? t : all(upper);
    Floats floor_t = floor(t);
    if constexpr (Last > 1) {
      const int highest = (row.size[a] > Last ? row.size[a] - Last : 0) - whole;
      const Floats limit = all(static_cast<float>(highest));
      floor_t = floor_t < limit ? floor_t : limit;
    }
    p.fraction[a] = t - floor_t;
    const Ints n = __builtin_convertvector(floor_t, Ints);
    p.base += static_cast<long>(whole) * row.stride[a];
    offset += n * row.stride[a];
  }
  std::memcpy(p.offset, &offset, sizeof offset);
  return p;
}

/// Values and gradients (per index) of one register of samples.
template <int Dim>
struct Samples {
  Floats value;
  Floats gradient[Dim];
};

/// Weights of the four pixels around a sample, and their derivatives.
struct CubicWeights {
  explicit CubicWeights(Floats t) {
    const Floats s = 1.0f - t, tt = t * t, ss = s * s;
    w[0] = ss * s * (1.0f / 6);
    w[1] = (2.0f / 3) + tt * (0.5f * t - 1.0f);
    w[2] = (2.0f / 3) + ss * (0.5f * s - 1.0f);
    w[3] = tt * t * (1.0f / 6);
    d[0] = -0.5f * ss;
    d[1] = t * (1.5f * t - 2.0f);
    d[2] = s * (2.0f - 1.5f * s);
    d[3] = 0.5f * tt;
  }
  Floats w[4], d[4];
};

/// Where the neighbours of the samples g and 4 + g begin.
template <int Dim>
struct Corners {
  Corners(const Position<Dim>& p, int g, long delta) : low(p.base + (p.offset[g] + delta)) {
#if defined(__AVX2__)
    high = p.base + (p.offset[4 + g] + delta);
#endif
  }
  /// Four neighbours along the first axis.
  Floats load(long delta) const {
#if defined(__AVX2__)
    return load_quads(low + delta, high + delta);
#else
    return load_quad(low + delta);
#endif
  }
  const float* low;
  const float* high = nullptr;
};

/// Sums over the rows of one plane of 4 x 4 neighbours: V with the weights, D with their derivatives.
template <int G, bool Gradient, int Dim>
inline void sum_plane(const Corners<Dim>& corners, const CubicWeights& y, long plane, long stride,
                      Floats& value, Floats& derivative) {
  value = Floats{};
  derivative = Floats{};
  for (int j = 0; j < 4; ++j) {
    const Floats pixels = corners.load(plane + j * stride);
    value += pixels * spread<G>(y.w[j]);
    if constexpr (Gradient) derivative += pixels * spread<G>(y.d[j]);
  }
}

template <bool Gradient>
struct Cubic2 {
  static constexpr int kDim = 2;
  static constexpr int kLast = 1;  // the neighbours of the last pixel are in the padding
  Floats v[4], d[4];
  CubicWeights x, y;

  Cubic2(const InterpolationRow& row, const Position<2>& p) : x(p.fraction[0]), y(p.fraction[1]) {
    sum<0>(row, p);
    sum<1>(row, p);
    sum<2>(row, p);
    sum<3>(row, p);
  }

  template <int G>
  void sum(const InterpolationRow& row, const Position<2>& p) {
    const long stride = row.stride[1];
    sum_plane<G, Gradient>(Corners<2>(p, G, -1 - stride), y, 0, stride, v[G], d[G]);
  }

  Samples<2> samples() {
    Samples<2> s{};
    transpose(v);
    if constexpr (Gradient) transpose(d);
    for (int c = 0; c < 4; ++c) {
      s.value += x.w[c] * v[c];
      if constexpr (Gradient) {
        s.gradient[0] += x.d[c] * v[c];
        s.gradient[1] += x.w[c] * d[c];
      }
    }
    return s;
  }
};

template <bool Gradient>
struct Cubic3 {
  static constexpr int kDim = 3;
  static constexpr int kLast = 1;
  Floats v[4], dy[4], dz[4];
  CubicWeights x, y, z;

  Cubic3(const InterpolationRow& row, const Position<3>& p)
      : x(p.fraction[0]), y(p.fraction[1]), z(p.fraction[2]) {
    sum<0>(row, p);
    sum<1>(row, p);
    sum<2>(row, p);
    sum<3>(row, p);
  }

  template <int G>
  void sum(const InterpolationRow& row, const Position<3>& p) {
    const long stride = row.stride[1], plane = row.stride[2];
    const Corners<3> corners(p, G, -1 - stride - plane);
    v[G] = dy[G] = dz[G] = Floats{};
    for (int k = 0; k < 4; ++k) {
      Floats value, derivative;
      sum_plane<G, Gradient>(corners, y, k * plane, stride, value, derivative);
      v[G] += value * spread<G>(z.w[k]);
      if constexpr (Gradient) {
        dy[G] += derivative * spread<G>(z.w[k]);
        dz[G] += value * spread<G>(z.d[k]);
      }
    }
  }

  Samples<3> samples() {
    Samples<3> s{};
    transpose(v);
    if constexpr (Gradient) {
      transpose(dy);
      transpose(dz);
    }
    for (int c = 0; c < 4; ++c) {
      s.value += x.w[c] * v[c];
      if constexpr (Gradient) {
        s.gradient[0] += x.d[c] * v[c];
        s.gradient[1] += x.w[c] * dy[c];
        s.gradient[2] += x.w[c] * dz[c];
      }
    }
    return s;
  }
};

/// The 2 x 2 pixels around each sample in one plane: (0,0), (1,0), (0,1), (1,1).
template <int Dim>
inline void load_cells(const Position<Dim>& p, long plane, int stride, Floats (&cell)[4]) {
  for (int g = 0; g < 4; ++g) {
    const float* low = p.base + p.offset[g] + plane;
#if defined(__AVX2__)
    const float* high = p.base + p.offset[4 + g] + plane;
    cell[g] = join(load_pairs(low, low + stride), load_pairs(high, high + stride));
#else
    cell[g] = load_pairs(low, low + stride);
#endif
  }
  transpose(cell);
}

/// Bilinear value and derivatives within one plane.
struct Bilinear {
  Bilinear(const Floats (&cell)[4], Floats x, Floats y) {
    const Floats low = cell[1] - cell[0], high = cell[3] - cell[2];
    const Floats a = cell[0] + x * low, b = cell[2] + x * high;
    dx = low + y * (high - low);
    dy = b - a;
    value = a + y * dy;
  }
  Floats value, dx, dy;
};

template <bool>
struct Linear2 {
  static constexpr int kDim = 2;
  static constexpr int kLast = 2;  // the last cell begins at the pixel before the last
  Samples<2> s;

  Linear2(const InterpolationRow& row, const Position<2>& p) {
    Floats cell[4];
    load_cells(p, 0, row.stride[1], cell);
    const Bilinear plane(cell, p.fraction[0], p.fraction[1]);
    s = {plane.value, {where(p.free[0], plane.dx), where(p.free[1], plane.dy)}};
  }
  Samples<2> samples() const { return s; }
};

template <bool>
struct Linear3 {
  static constexpr int kDim = 3;
  static constexpr int kLast = 2;
  Samples<3> s;

  Linear3(const InterpolationRow& row, const Position<3>& p) {
    Floats cell[4];
    load_cells(p, 0, row.stride[1], cell);
    const Bilinear front(cell, p.fraction[0], p.fraction[1]);
    load_cells(p, row.stride[2], row.stride[1], cell);
    const Bilinear back(cell, p.fraction[0], p.fraction[1]);
    const Floats z = p.fraction[2], dz = back.value - front.value;
    s = {front.value + z * dz,
         {where(p.free[0], front.dx + z * (back.dx - front.dx)),
          where(p.free[1], front.dy + z * (back.dy - front.dy)), where(p.free[2], dz)}};
  }
  Samples<3> samples() const { return s; }
};

/// Samples i .. i + kLanes - 1 of the row, whose displacements and results stand at the pointers.
template <template <bool> class Method, bool Gradient, int Dim>
inline void sample(const InterpolationRow& row, const RowConstants<Dim>& constants, int i,
                   const float* const (&displacement)[3], float* value, float* const (&gradient)[3],
                   float* inside) {
  const auto p = locate<Method<Gradient>::kLast, Dim>(row, constants, i, displacement);
  const auto s = Method<Gradient>(row, p).samples();
  store(value, s.value + p.poison);
  store(inside, where(p.inside, all(1.0f)));
  if constexpr (Gradient) {
    for (int a = 0; a < Dim; ++a) {  // d/dx_a = sum_b d(index_b)/dx_a d/d(index_b)
      Floats g = {};
      for (int b = 0; b < Dim; ++b) g += row.to_index[b][a] * s.gradient[b];
      if (gradient[a] != nullptr) store(gradient[a], where(p.inside, g));
    }
  }
}

template <typename Pointer>
Pointer advance(Pointer p, int i) {
  return p == nullptr ? nullptr : p + i;
}

/// The last samples of a row, fewer than a register: through buffers, so that nothing beyond the row
/// is read or written.
template <template <bool> class Method, bool Gradient, int Dim>
void sample_tail(const InterpolationRow& row, const RowConstants<Dim>& constants, int i) {
  const int count = row.end - i;
  float in[3][kLanes] = {}, out[3][kLanes], value[kLanes], inside[kLanes];
  const float* displacement[3] = {};
  float* gradient[3] = {};
  for (int a = 0; a < Dim; ++a) {
    for (int l = 0; l < count && row.displacement[a] != nullptr; ++l) {
      in[a][l] = row.displacement[a][i + l];
    }
    displacement[a] = in[a];
    gradient[a] = out[a];
  }
  sample<Method, Gradient, Dim>(row, constants, i, displacement, value, gradient, inside);
  for (int l = 0; l < count; ++l) {
    row.value[i + l] = value[l];
    row.inside[i + l] = inside[l];
    for (int a = 0; Gradient && a < Dim; ++a) {
      if (row.gradient[a] != nullptr) row.gradient[a][i + l] = out[a][l];
    }
  }
}

template <template <bool> class Method, bool Gradient>
void sample_row(const InterpolationRow& row) {
  constexpr int kDim = Method<Gradient>::kDim;
  const RowConstants<kDim> constants(row);
  int i = row.begin;
  for (; i + kLanes <= row.end; i += kLanes) {
    const float* displacement[3] = {};
    float* gradient[3] = {};
    for (int a = 0; a < kDim; ++a) {
      displacement[a] = advance(row.displacement[a], i);
      gradient[a] = advance(row.gradient[a], i);
    }
    sample<Method, Gradient, kDim>(row, constants, i, displacement, row.value + i, gradient,
                                   row.inside + i);
  }
  if (i < row.end) sample_tail<Method, Gradient, kDim>(row, constants, i);
}

template <template <bool> class Method>
void dispatch(const InterpolationRow& row) {
  bool wanted = false;
  for (const float* g : row.gradient) wanted = wanted || g != nullptr;
  wanted ? sample_row<Method, true>(row) : sample_row<Method, false>(row);
}

}  // namespace

void cubic_row_2(const InterpolationRow& row) { dispatch<Cubic2>(row); }
void cubic_row_3(const InterpolationRow& row) { dispatch<Cubic3>(row); }
void linear_row_2(const InterpolationRow& row) { dispatch<Linear2>(row); }
void linear_row_3(const InterpolationRow& row) { dispatch<Linear3>(row); }

}  // namespace crease::CREASE_ISA
