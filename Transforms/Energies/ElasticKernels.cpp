// The formulas of StoredEnergy.h at four points at once, and the sums over a cell's points.
#include "Transforms/Energies/ElasticKernels.h"

namespace crease::CREASE_ISA {
namespace {

using Real4 = double __attribute__((vector_size(32)));
using Mask4 = long long __attribute__((vector_size(32)));
using Unaligned4 = double __attribute__((vector_size(32), aligned(8)));

inline Real4 load(const double* p) { return *reinterpret_cast<const Unaligned4*>(p); }
inline void store(double* p, Real4 v) { *reinterpret_cast<Unaligned4*>(p) = v; }
inline Real4 splat(double v) { return Real4{v, v, v, v}; }
inline Real4 choose(Mask4 mask, Real4 yes, Real4 no) {
  return reinterpret_cast<Real4>((mask & reinterpret_cast<Mask4>(yes)) |
                                 (~mask & reinterpret_cast<Mask4>(no)));
}
inline Real4 smaller(Real4 a, Real4 b) { return choose(a < b, a, b); }

template <int Dim>
constexpr int kSize = Dim* Dim;

/// Position of the pair a <= b.
template <int Dim>
constexpr int pair_of(int a, int b) {
  return a * Dim - a * (a - 1) / 2 + b - a;
}

/// dJ/dF = J F^-T.
template <int Dim>
inline void cofactor(const Real4* F, Real4* C) {
  if constexpr (Dim == 2) {
    C[0] = F[3], C[1] = -F[2], C[2] = -F[1], C[3] = F[0];
  } else {
    for (int a = 0; a < 3; ++a) {
      for (int s = 0; s < 3; ++s) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, s1 = (s + 1) % 3, s2 = (s + 2) % 3;
        C[3 * a + s] = F[3 * a1 + s1] * F[3 * a2 + s2] - F[3 * a1 + s2] * F[3 * a2 + s1];
      }
    }
  }
}

template <int Dim>
inline Real4 determinant(const Real4* F, const Real4* C) {
  Real4 J = F[0] * C[0];
  for (int s = 1; s < Dim; ++s) J += F[s] * C[s];
  return J;
}

/// A_as,bt += factor d^2 J / dF_as dF_bt.
template <int Dim>
inline void add_second_derivative_of_J(const Real4* F, Real4 factor, Real4* A) {
  for (int a = 0; a < Dim; ++a) {
    for (int b = a + 1; b < Dim; ++b) {
      for (int s = 0; s < Dim; ++s) {
        for (int t = 0; t < Dim; ++t) {
          if (s == t) continue;
          Real4 second = splat(s < t ? 1.0 : -1.0);
          if constexpr (Dim == 3) {
            const int c = 3 - a - b, u = 3 - s - t;
            const bool even = ((b - a + 3) % 3 == 1) == ((t - s + 3) % 3 == 1);
            second = even ? F[3 * c + u] : -F[3 * c + u];
          }
          A[(pair_of<Dim>(a, b) * Dim + s) * Dim + t] += factor * second;
        }
      }
    }
  }
}

/// What a law says at four points.
template <int Dim>
struct Answer {
  Real4 energy;
  Real4 P[kSize<Dim>];
  Real4 A[Dim * (Dim + 1) / 2 * kSize<Dim>];
};

template <int Dim>
void st_venant_kirchhoff(const Real4* F, Real4 lambda, Real4 mu, Real4 slope, bool tangent,
                         Answer<Dim>& answer) {
  Real4 E[kSize<Dim>], S[kSize<Dim>];
  Real4 trace = splat(0), square = splat(0);
  for (int s = 0; s < Dim; ++s) {
    for (int t = 0; t < Dim; ++t) {
      Real4 product = splat(s == t ? -1.0 : 0.0);
      for (int a = 0; a < Dim; ++a) product += F[Dim * a + s] * F[Dim * a + t];
      E[Dim * s + t] = 0.5 * product;
      square += E[Dim * s + t] * E[Dim * s + t];
    }
    trace += E[Dim * s + s];
  }
  answer.energy = 0.5 * lambda * trace * trace + mu * square;
  for (int s = 0; s < Dim; ++s) {
    for (int t = 0; t < Dim; ++t) S[Dim * s + t] = 2 * mu * E[Dim * s + t];
    S[Dim * s + s] += lambda * trace + slope;
  }
  for (int a = 0; a < Dim; ++a) {
    for (int s = 0; s < Dim; ++s) {
      Real4 stress = splat(0);
      for (int t = 0; t < Dim; ++t) stress += F[Dim * a + t] * S[Dim * t + s];
      answer.P[Dim * a + s] = stress;
    }
  }
  if (!tangent) return;
  for (int a = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b) {
      Real4 rows = splat(0);  // (F F^T)_ab
      for (int u = 0; u < Dim; ++u) rows += F[Dim * a + u] * F[Dim * b + u];
      for (int s = 0; s < Dim; ++s) {
        for (int t = 0; t < Dim; ++t) {
          Real4 entry =
              lambda * F[Dim * a + s] * F[Dim * b + t] + mu * F[Dim * b + s] * F[Dim * a + t];
          if (s == t) entry += mu * rows;
          if (a == b) entry += S[Dim * s + t];
          answer.A[(pair_of<Dim>(a, b) * Dim + s) * Dim + t] = entry;
        }
      }
    }
  }
}

inline Real4 logarithm(Real4 J) {
  Real4 result;
  for (int lane = 0; lane < 4; ++lane) result[lane] = __builtin_log(J[lane]);
  return result;
}

template <int Dim>
void neo_hookean(const Real4* F, const Real4* C, Real4 det, Real4 lambda, Real4 mu, Real4 slope,
                 bool tangent, Answer<Dim>& answer) {
  const Mask4 folded = det <= splat(0);
  const Real4 J = choose(folded, splat(1), det);
  const Real4 log_J = logarithm(J);
  Real4 square = splat(-Dim);
  for (int r = 0; r < kSize<Dim>; ++r) square += F[r] * F[r];
  answer.energy = choose(folded, splat(__builtin_inf()),
                         0.5 * mu * square - mu * log_J + 0.5 * lambda * log_J * log_J);
  const Real4 pull = (lambda * log_J - mu) / J + slope;
  for (int r = 0; r < kSize<Dim>; ++r) answer.P[r] = mu * F[r] + pull * C[r];
  if (!tangent) return;
  const Real4 steepness = (lambda * (1 - log_J) + mu) / (J * J);  // d pull / dJ
  for (int a = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b) {
      for (int s = 0; s < Dim; ++s) {
        for (int t = 0; t < Dim; ++t) {
          Real4 entry = steepness * C[Dim * a + s] * C[Dim * b + t];
          if (a == b && s == t) entry += mu;
          answer.A[(pair_of<Dim>(a, b) * Dim + s) * Dim + t] = entry;
        }
      }
    }
  }
  add_second_derivative_of_J<Dim>(F, pull, answer.A);
}

/// The least pivot of L D L^T over the trace. A pivot of nearly 0 beside entries that are not is negative.
template <int Dim>
Real4 least_pivot(const Real4* A) {
  constexpr int n = kSize<Dim>;
  Real4 M[n][n];
  Real4 trace = splat(0);
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k <= i; ++k) {
      // Lower entry (b t, a s) with a <= b is entry (a s, b t).
      const int b = i / Dim, t = i % Dim, a = k / Dim, s = k % Dim;
      M[i][k] = A[(pair_of<Dim>(a, b) * Dim + s) * Dim + t];
    }
    trace += M[i][i];
  }
  const Real4 scale = choose(trace > splat(0), trace, splat(1));
  const Real4 tiny = 1e-12 * scale;
  Real4 least = choose(trace > splat(0), splat(1), splat(-1));
  for (int j = 0; j < n; ++j) {
    const Real4 pivot = M[j][j];
    least = smaller(least, pivot / scale);
    const Mask4 usable = pivot > tiny;
    const Real4 inverse = choose(usable, 1 / choose(usable, pivot, scale), splat(0));
    for (int i = j + 1; i < n; ++i) {
      const Real4 size = choose(M[i][j] < splat(0), -M[i][j], M[i][j]);
      const Mask4 stray = (size > 1e-6 * scale) & ~usable;
      least = choose(stray, splat(-1), least);
      const Real4 factor = M[i][j] * inverse;
      for (int k = j + 1; k <= i; ++k) M[i][k] -= factor * M[k][j];
    }
  }
  return least;
}

template <int Dim>
inline void load_deformation(const ElasticCell& cell, int p, Real4* F) {
  for (int r = 0; r < kSize<Dim>; ++r) F[r] = load(cell.deformation + r * cell.stride + p);
}

/// The sums of four vectors' lanes.
inline Real4 sums(Real4 t0, Real4 t1, Real4 t2, Real4 t3) {
  const Real4 u =
      __builtin_shuffle(t0, t1, Mask4{0, 4, 2, 6}) + __builtin_shuffle(t0, t1, Mask4{1, 5, 3, 7});
  const Real4 v =
      __builtin_shuffle(t2, t3, Mask4{0, 4, 2, 6}) + __builtin_shuffle(t2, t3, Mask4{1, 5, 3, 7});
  return __builtin_shuffle(u, v, Mask4{0, 1, 4, 5}) + __builtin_shuffle(u, v, Mask4{2, 3, 6, 7});
}

/// F_as at points p .. p + 3, those beyond the last repeated.
inline Real4 four_gradients(const ElasticCell& cell, int a, int s, int p, double linear) {
  const int w = cell.width, last = cell.num_points - 1;
  const double* column[4];
  for (int j = 0; j < 4; ++j) {
    column[j] = cell.gradients + (s * cell.num_points + (p + j < last ? p + j : last)) * w;
  }
  Real4 total[4] = {splat(0), splat(0), splat(0), splat(0)};
  for (int v = 0; v < w; v += 4) {
    const Real4 phi = load(cell.phi + a * w + v);
    for (int j = 0; j < 4; ++j) total[j] += phi * load(column[j] + v);
  }
  return splat(linear) + sums(total[0], total[1], total[2], total[3]);
}

template <int Dim>
void deformation(const ElasticCell& cell) {
  for (int p = 0; p < cell.stride; p += 4) {
    Real4 F[kSize<Dim>], C[kSize<Dim>];
    for (int a = 0; a < Dim; ++a) {
      for (int s = 0; s < Dim; ++s) {
        const int r = Dim * a + s;
        F[r] = four_gradients(cell, a, s, p, cell.linear[r]);
        store(cell.deformation + r * cell.stride + p, F[r]);
      }
    }
    cofactor<Dim>(F, C);
    store(cell.determinant + p, determinant<Dim>(F, C));
  }
}

template <int Dim>
void dilatation(const ElasticCell& cell) {
  for (int p = 0; p < cell.stride; p += 4) {
    Real4 F[kSize<Dim>], C[kSize<Dim>];
    load_deformation<Dim>(cell, p, F);
    cofactor<Dim>(F, C);
    const Real4 weight = load(cell.weight + p);
    Real4 trace = splat(-Dim);
    for (int r = 0; r < kSize<Dim>; ++r) trace += F[r] * F[r];
    store(cell.energy + p, weight * (cell.neo_hookean ? determinant<Dim>(F, C) : 0.5 * trace));
    for (int r = 0; r < kSize<Dim>; ++r) {
      store(cell.stress + r * cell.stride + p, weight * (cell.neo_hookean ? C[r] : F[r]));
    }
  }
}

template <int Dim>
void stress(const ElasticCell& cell) {
  const bool tangent = cell.tangent != nullptr;
  Answer<Dim> answer;
  for (int p = 0; p < cell.stride; p += 4) {
    Real4 F[kSize<Dim>], C[kSize<Dim>];
    load_deformation<Dim>(cell, p, F);
    const Real4 weight = load(cell.weight + p), mu = load(cell.mu + p);
    const Real4 lambda = cell.mean_dilatation ? splat(0) : load(cell.lambda + p);
    const Real4 slope = splat(cell.mean_dilatation ? cell.dilatation_slope : 0.0);
    if (cell.neo_hookean) {
      cofactor<Dim>(F, C);
      neo_hookean<Dim>(F, C, determinant<Dim>(F, C), lambda, mu, slope, tangent, answer);
    } else {
      st_venant_kirchhoff<Dim>(F, lambda, mu, slope, tangent, answer);
    }
    store(cell.energy + p, choose(weight > splat(0), weight * answer.energy, splat(0)));
    for (int r = 0; r < kSize<Dim>; ++r) {
      store(cell.stress + r * cell.stride + p, weight * answer.P[r]);
    }
    if (!tangent) continue;
    store(cell.pivot + p, least_pivot<Dim>(answer.A));
    for (int r = 0; r < Dim * (Dim + 1) / 2 * kSize<Dim>; ++r) {
      store(cell.tangent + r * cell.stride + p, weight * answer.A[r]);
    }
  }
}

template <int Dim>
void forces(const ElasticCell& cell, double* result) {
  const int w = cell.width, q = cell.num_points;
  for (int s = 0; s < Dim; ++s) {
    for (int p = 0; p < q; ++p) {
      const double* column = cell.gradients + (s * q + p) * w;
      for (int a = 0; a < Dim; ++a) {
        const Real4 stress = splat(cell.stress[(Dim * a + s) * cell.stride + p]);
        double* row = result + a * w;
        for (int v = 0; v < w; v += 4) store(row + v, load(row + v) + stress * load(column + v));
      }
    }
  }
}

/// Rows i .. i + 3 of sum_r G_r^T Y_r, columns first .. first + 4 Blocks - 1.
template <int Blocks>
inline void four_rows(const double* G, const double* Y, int count, int w, int i, int first,
                      double* result) {
  Real4 total[4][Blocks];
  for (int j = 0; j < 4; ++j) {
    for (int v = 0; v < Blocks; ++v) total[j][v] = splat(0);
  }
  for (int r = 0; r < count; ++r) {
    Real4 y[Blocks];
    for (int v = 0; v < Blocks; ++v) y[v] = load(Y + r * w + first + 4 * v);
    for (int j = 0; j < 4; ++j) {
      const Real4 g = splat(G[r * w + i + j]);
      for (int v = 0; v < Blocks; ++v) total[j][v] += g * y[v];
    }
  }
  for (int j = 0; j < 4; ++j) {
    for (int v = 0; v < Blocks; ++v) {
      store(result + (i + j) * w + first + 4 * v, total[j][v]);
    }
  }
}

void product(const double* G, const double* Y, int count, int w, bool lower_half, double* result) {
  for (int i = 0; i < w; i += 4) {
    const int end = lower_half ? i + 4 : w;
    int first = 0;
    for (; first + 8 <= end; first += 8) four_rows<2>(G, Y, count, w, i, first, result);
    if (first < end) four_rows<1>(G, Y, count, w, i, first, result);
  }
}

template <int Dim>
void hessian(const ElasticCell& cell, double* result) {
  const int w = cell.width, q = cell.num_points;
  for (int a = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b) {
      const int pair = pair_of<Dim>(a, b);
      for (int s = 0; s < Dim; ++s) {
        for (int p = 0; p < q; ++p) {
          Real4 factor[Dim];
          for (int t = 0; t < Dim; ++t) {
            factor[t] = splat(cell.tangent[((pair * Dim + s) * Dim + t) * cell.stride + p]);
          }
          double* y = cell.products + (s * q + p) * w;
          for (int v = 0; v < w; v += 4) {
            Real4 total = factor[0] * load(cell.gradients + p * w + v);
            for (int t = 1; t < Dim; ++t) {
              total += factor[t] * load(cell.gradients + (t * q + p) * w + v);
            }
            store(y + v, total);
          }
        }
      }
      product(cell.gradients, cell.products, Dim * q, w, a == b, result + pair * w * w);
    }
  }
}

}  // namespace

void elastic_deformation_2(const ElasticCell& cell) { deformation<2>(cell); }
void elastic_deformation_3(const ElasticCell& cell) { deformation<3>(cell); }
void elastic_dilatation_2(const ElasticCell& cell) { dilatation<2>(cell); }
void elastic_dilatation_3(const ElasticCell& cell) { dilatation<3>(cell); }
void elastic_stress_2(const ElasticCell& cell) { stress<2>(cell); }
void elastic_stress_3(const ElasticCell& cell) { stress<3>(cell); }
void elastic_forces_2(const ElasticCell& cell, double* result) { forces<2>(cell, result); }
void elastic_forces_3(const ElasticCell& cell, double* result) { forces<3>(cell, result); }
void elastic_hessian_2(const ElasticCell& cell, double* result) { hessian<2>(cell, result); }
void elastic_hessian_3(const ElasticCell& cell, double* result) { hessian<3>(cell, result); }

}  // namespace crease::CREASE_ISA
