#include "Metrics/SumOfSquaredDifferencesKernel.h"

#include "Metrics/QuadLanes.h"

namespace crease::CREASE_ISA {
namespace {

/// Running sums, four lanes each.
struct LaneSums {
  Quad squares = {};
  Quad weight = {};
  Quad weight_inside = {};

  SsdSums total() const {
    const Quad t = sums_of_lanes(squares, weight, weight_inside, Quad{});
    return {t[0], t[1], t[2]};
  }
};

template <int Dim>
struct FourSamples {
  Quad gradient[Dim];
  Quad weight;  ///< times the sample volume
};

/// Differences of the samples i .. i+3, weighted; adds to the sums.
inline Quad weighted_differences(const SsdRow& row, int i, LaneSums& sums) {
  const Quad weight = load(row.weight + i);
  const Quad difference = load(row.value + i) - load(row.fixed + i);
  const Quad weighted = weight * difference;
  sums.squares += weighted * difference;
  sums.weight += weight;
  sums.weight_inside += weight * load(row.inside + i);
  return weighted;
}

/// Forces of the samples i .. i+3.
template <int Dim>
inline FourSamples<Dim> visit(const SsdRow& row, int i, LaneSums& sums) {
  FourSamples<Dim> four;
  const Quad weighted = weighted_differences(row, i, sums) * row.volume;
  four.weight = load(row.weight + i) * row.volume;
  for (int a = 0; a < Dim; ++a) {
    four.gradient[a] = load(row.gradient[a] + i);
    store(row.force[a] + i, weighted * four.gradient[a]);
  }
  return four;
}

template <int Dim>
void add_curvature(const SsdRow& row, int i, const FourSamples<Dim>* fours) {
  int k = 0;
  for (int a = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++k) {
      Quad product[4];
      for (int q = 0; q < 4; ++q) {
        product[q] = fours[q].weight * fours[q].gradient[a] * fours[q].gradient[b];
      }
      float* out = row.curvature[k] + i / 4;
      store(out, load(out) + sums_of_lanes(product[0], product[1], product[2], product[3]));
    }
  }
}

template <int Dim>
void add_curvature_of_one_block(const SsdRow& row, int i, const FourSamples<Dim>& four) {
  int k = 0;
  for (int a = 0; a < Dim; ++a) {
    for (int b = a; b < Dim; ++b, ++k) {
      const Quad product = four.weight * four.gradient[a] * four.gradient[b];
      row.curvature[k][i / 4] += sums_of_lanes(product, product, product, product)[0];
    }
  }
}

template <int Dim>
SsdSums run(const SsdRow& row) {
  const int last = (row.end + 3) / 4 * 4;
  int i = row.begin / 4 * 4;
  LaneSums sums;
  if (row.force[0] == nullptr) {
    for (; i < last; i += 4) weighted_differences(row, i, sums);
    return sums.total();
  }
  for (; i + 16 <= last; i += 16) {
    FourSamples<Dim> fours[4];
    for (int q = 0; q < 4; ++q) fours[q] = visit<Dim>(row, i + 4 * q, sums);
    if (row.curvature[0] != nullptr) add_curvature<Dim>(row, i, fours);
  }
  for (; i < last; i += 4) {
    const FourSamples<Dim> four = visit<Dim>(row, i, sums);
    if (row.curvature[0] != nullptr) add_curvature_of_one_block<Dim>(row, i, four);
  }
  return sums.total();
}

}  // namespace

SsdSums ssd_row(const SsdRow& row, int dim) { return dim == 2 ? run<2>(row) : run<3>(row); }

}  // namespace crease::CREASE_ISA
