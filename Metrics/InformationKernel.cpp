#include "Metrics/InformationKernel.h"

#include "Metrics/QuadLanes.h"

namespace crease::CREASE_ISA {
namespace {

constexpr int kLanes = 4;
constexpr float kSixth = 1.0f / 6;

/// Four positions among bins: whole part and rest, and whether intensities lie in the range.
struct Positions {
  Positions(Quad intensity, const BinScale& scale) {
    const Quad free = (intensity - scale.lower) * scale.per_intensity + 2.0f;
    const Quad lowest = Quad{} + 2.0f, highest = Quad{} + scale.last;
    const Quad raised = free > lowest ? free : lowest;  // what is not a number, too
    const Quad position = raised < highest ? raised : highest;
    inside = free == position;
    whole = __builtin_convertvector(position, QuadIndex);
    rest = position - __builtin_convertvector(whole, Quad);
  }
  QuadIndex whole, inside;
  Quad rest;
};

/// The cubic B-spline's shares in the four bins about four positions, as CubicWindow.
struct Shares {
  explicit Shares(Quad t) {
    const Quad s = 1.0f - t, tt = t * t, ss = s * s;
    value[0] = ss * s * kSixth;
    value[1] = 2.0f / 3 - tt + 0.5f * tt * t;
    value[2] = 2.0f / 3 - ss + 0.5f * ss * s;
    value[3] = tt * t * kSixth;
  }
  Quad value[4];
};

/// Bins of four fixed intensities, in each of which they have all.
class BoxWindow {
 public:
  static constexpr int kBins = 1;
  BoxWindow(const HistogramRow& row, int i) {
    for (int n = 0; n < kLanes; ++n) bin_[n] = row.fixed_bin[i + n];
  }
  int first(int n) const { return bin_[n]; }
  static float share(int, int) { return 1; }

 private:
  int bin_[kLanes];
};

/// Bins of four fixed intensities and their shares in four of them.
class CubicFixedWindow {
 public:
  static constexpr int kBins = 4;
  CubicFixedWindow(const HistogramRow& row, int i) {
    const Positions at(load(row.fixed + i), row.fixed_scale);
    const Shares shares(at.rest);
    for (int n = 0; n < kLanes; ++n) first_[n] = at.whole[n] - 1;
    for (int b = 0; b < kBins; ++b) store(share_[b], shares.value[b]);
  }
  int first(int n) const { return first_[n]; }
  float share(int b, int n) const { return share_[b][n]; }

 private:
  int first_[kLanes];
  float share_[kBins][kLanes];
};

void add_counts(std::int32_t* cells, Quad counts) {
  QuadIndex sum;
  __builtin_memcpy(&sum, cells, sizeof sum);
  sum += __builtin_convertvector(counts + 0.5f, QuadIndex);
  __builtin_memcpy(cells, &sum, sizeof sum);
}

/// Four samples from i on, the n-th into the n-th histogram.
template <typename Window>
void add_four(const HistogramRow& row, int i, float counts, std::int32_t* histograms) {
  const Window fixed(row, i);
  const Positions moving(load(row.moving + i), row.moving_scale);
  Shares shares(moving.rest);
  const Quad weight = load(row.weight + i) * counts;
  for (Quad& share : shares.value) share *= weight;
  transpose(shares.value);  // entry n: of sample n
  const int size = row.bins * row.bins;
  for (int n = 0; n < kLanes; ++n) {
    std::int32_t* cells = histograms + n * size + fixed.first(n) * row.bins + moving.whole[n] - 1;
    for (int b = 0; b < Window::kBins; ++b) {
      add_counts(cells + b * row.bins, shares.value[n] * fixed.share(b, n));
    }
  }
}

/// Derivatives of four samples from i on.
template <typename Window>
void four_slopes(const HistogramRow& row, int i, const InformationSlopes& out) {
  const Window fixed(row, i);
  const Positions moving(load(row.moving + i), row.moving_scale);
  Quad cell[kLanes] = {};
  Quad start = {};
  for (int n = 0; n < kLanes; ++n) {
    const int at = fixed.first(n) * row.bins + moving.whole[n];
    for (int b = 0; b < Window::kBins; ++b) {
      cell[n] += fixed.share(b, n) * load(out.cells + kLanes * (at + b * row.bins));
      if (out.start != nullptr) start[n] += fixed.share(b, n) * out.start[at + b * row.bins];
    }
  }
  transpose(cell);
  const Quad t = moving.rest, weight = load(row.weight + i);
  const Quad slope = (cell[0] + t * (cell[1] + t * cell[2])) * row.moving_scale.per_intensity;
  store(out.by_moving + i, moving.inside ? weight * slope : Quad{});
  store(out.curvature + i, weight * cell[3]);
  if (out.start == nullptr) return;
  const Quad rise = t * (cell[0] + t * (0.5f * cell[1] + t * cell[2] * (1.0f / 3)));
  store(out.by_weight + i, start + rise - out.mean);
}

/// The last few samples of a row, filled up with samples of weight 0.
struct Tail {
  Tail(const HistogramRow& row, int begin) {
    tail = row;
    tail.count = kLanes;
    for (int n = 0; begin + n < row.count; ++n) {
      weight[n] = row.weight[begin + n];
      moving[n] = row.moving[begin + n];
      if (row.fixed_bin != nullptr) bin[n] = row.fixed_bin[begin + n];
      if (row.fixed_bin == nullptr) fixed[n] = row.fixed[begin + n];
    }
    tail.weight = weight;
    tail.moving = moving;
    tail.fixed_bin = row.fixed_bin != nullptr ? bin : nullptr;
    tail.fixed = fixed;
  }
  Tail(const Tail&) = delete;
  Tail& operator=(const Tail&) = delete;

  HistogramRow tail;
  float weight[kLanes] = {}, moving[kLanes] = {}, fixed[kLanes] = {};
  std::uint8_t bin[kLanes] = {};
};

template <typename Window>
void add(const HistogramRow& row, float counts, std::int32_t* histograms) {
  int i = 0;
  for (; i + kLanes <= row.count; i += kLanes) add_four<Window>(row, i, counts, histograms);
  if (i < row.count) add_four<Window>(Tail(row, i).tail, 0, counts, histograms);
}

template <typename Window>
void slopes(const HistogramRow& row, const InformationSlopes& out) {
  int i = 0;
  for (; i + kLanes <= row.count; i += kLanes) four_slopes<Window>(row, i, out);
  if (i == row.count) return;
  const Tail last(row, i);
  float by_moving[kLanes], curvature[kLanes], by_weight[kLanes];
  InformationSlopes to = out;
  to.by_moving = by_moving;
  to.curvature = curvature;
  to.by_weight = by_weight;
  four_slopes<Window>(last.tail, 0, to);
  for (int n = 0; i + n < row.count; ++n) {
    out.by_moving[i + n] = by_moving[n];
    out.curvature[i + n] = curvature[n];
    if (out.start != nullptr) out.by_weight[i + n] = by_weight[n];
  }
}

}  // namespace

void add_to_histogram(const HistogramRow& row, float counts, std::int32_t* histograms) {
  row.fixed_bin != nullptr ? add<BoxWindow>(row, counts, histograms)
                           : add<CubicFixedWindow>(row, counts, histograms);
}

void information_slopes(const HistogramRow& row, const InformationSlopes& out) {
  row.fixed_bin != nullptr ? slopes<BoxWindow>(row, out) : slopes<CubicFixedWindow>(row, out);
}

}  // namespace crease::CREASE_ISA
