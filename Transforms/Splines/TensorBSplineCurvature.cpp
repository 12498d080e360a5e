#include "Transforms/Splines/TensorBSplineCurvature.h"

#include <algorithm>

#include "Core/Parallel.h"

namespace crease {

TensorBlockAxis::TensorBlockAxis(int degree, int spans, int begin, int end,
                                 std::span<const int> span, std::span<const double> weights,
                                 int block_size)
    : taps(degree + 1), num_pairs((degree + 1) * (degree + 2) / 2), num_spans(spans) {
  const int num_blocks = (static_cast<int>(span.size()) + block_size - 1) / block_size;
  products.assign(static_cast<std::size_t>(num_blocks * num_pairs), 0.0);
  std::vector<int> block_span(static_cast<std::size_t>(num_blocks), -1);
  for (int b = 0; b < num_blocks; ++b) {
    const int first = std::max(begin, b * block_size), last = std::min(end, (b + 1) * block_size);
    if (first >= last) continue;
    const int sample = std::clamp(b * block_size + block_size / 2, first, last - 1);
    block_span[b] = span[sample];
    for (int r = 0; r < taps; ++r) {
      for (int other = r; other < taps; ++other) {
        products[b * num_pairs + pair_index(r, other)] =
            weights[sample * taps + r] * weights[sample * taps + other];
      }
    }
  }
  // Uncovered blocks lie before and after the covered ones: their span is -1 or they come last.
  first_block.assign(static_cast<std::size_t>(num_spans) + 1, 0);
  int b = 0;
  while (b < num_blocks && block_span[b] < 0) ++b;
  for (int s = 0; s < num_spans; ++s) {
    first_block[s] = b;
    while (b < num_blocks && block_span[b] == s) ++b;
  }
  first_block[num_spans] = b;
}

namespace {

/// Curvature sums of the knot spans in one row of spans along the first axis: per span and triple of
/// pairs (along x, y, z; the last fastest) the components of the packed symmetric matrix.
template <int Dim>
class SpanRow {
 public:
  static constexpr int kComponents = kNumSecondDerivatives<Dim>;

  SpanRow(const std::array<TensorBlockAxis, Dim>& axes, const CurvatureBlocks<Dim>& blocks)
      : x_(axes[0]), y_(axes[1]), z_(third(axes)), blocks_(blocks) {
    along_x_.resize(static_cast<std::size_t>(x_.num_pairs) * kComponents);
    along_y_.resize(along_x_.size() * static_cast<std::size_t>(x_.num_spans * y_.num_pairs));
    all_.resize(along_y_.size() * static_cast<std::size_t>(z_.num_pairs));
  }

  /// Sums the blocks of the spans (., span_y, span_z); false when there are none.
  bool sum(int span_y, int span_z) {
    const int y_begin = y_.first_block[span_y], y_end = y_.first_block[span_y + 1];
    const int z_begin = z_.first_block[span_z], z_end = z_.first_block[span_z + 1];
    if (y_begin == y_end || z_begin == z_end) return false;
    std::fill(all_.begin(), all_.end(), 0.0);
    for (int bz = z_begin; bz < z_end; ++bz) {
      std::fill(along_y_.begin(), along_y_.end(), 0.0);
      for (int by = y_begin; by < y_end; ++by) add_block_row(by, bz);
      expand(along_y_.data(), along_y_.size(), z_, bz, all_.data());
    }
    return true;
  }

  void scatter(int span_y, int span_z, double scale, BlockHessian<Dim>& hessian) const {
    const int net_x = x_.num_spans + x_.taps - 1, net_y = y_.num_spans + y_.taps - 1;
    for (int span_x = 0; span_x < x_.num_spans; ++span_x) {
      if (x_.first_block[span_x] == x_.first_block[span_x + 1]) continue;
      const auto number = [&](int rx, int ry, int rz) {
        return span_x + rx + net_x * (span_y + ry + net_y * (span_z + rz));
      };
      for (int iz = 0; iz < z_.taps; ++iz) {
        for (int iy = 0; iy < y_.taps; ++iy) {
          for (int ix = 0; ix < x_.taps; ++ix) {
            const int i = number(ix, iy, iz);
            for (int kz = 0; kz <= iz; ++kz) {
              for (int ky = 0; ky < (kz < iz ? y_.taps : iy + 1); ++ky) {
                // Control points in a row follow each other in the pattern, too.
                int slot = hessian.pattern().slot(i, number(0, ky, kz));
                const int last = kz < iz || ky < iy ? x_.taps - 1 : ix;
                for (int kx = 0; kx <= last; ++kx, ++slot) {
                  add(span_x, x_.pair_index(ix, kx), y_.pair_index(iy, ky), z_.pair_index(iz, kz),
                      scale, hessian.block(slot));
                }
              }
            }
          }
        }
      }
    }
  }

 private:
  static TensorBlockAxis third(const std::array<TensorBlockAxis, Dim>& axes) {
    if constexpr (Dim == 3) return axes[2];
    TensorBlockAxis one;
    one.first_block = {0, 1};
    one.products = {1.0};
    return one;
  }

  void add_block_row(int by, int bz) {
    std::int64_t first = static_cast<std::int64_t>(by) * blocks_.blocks[0];
    if constexpr (Dim == 3) {
      first += static_cast<std::int64_t>(bz) * blocks_.blocks[0] * blocks_.blocks[1];
    }
    double* target = along_y_.data();
    for (int span = 0; span < x_.num_spans; ++span) {
      std::fill(along_x_.begin(), along_x_.end(), 0.0);
      for (int b = x_.first_block[span]; b < x_.first_block[span + 1]; ++b) {
        std::array<double, kComponents> g;
        for (int c = 0; c < kComponents; ++c) g[c] = blocks_.sums[c][first + b];
        expand(g.data(), g.size(), x_, b, along_x_.data());
      }
      expand(along_x_.data(), along_x_.size(), y_, by, target);
      target += along_x_.size() * static_cast<std::size_t>(y_.num_pairs);
    }
  }

  /// Every group of components times every product of the axis at the block, added to out.
  static void expand(const double* sums, std::size_t count, const TensorBlockAxis& axis, int block,
                     double* out) {
    const double* products = axis.products.data() + block * axis.num_pairs;
    for (const double* end = sums + count; sums < end; sums += kComponents) {
      for (int p = 0; p < axis.num_pairs; ++p, out += kComponents) {
        for (int c = 0; c < kComponents; ++c) out[c] += sums[c] * products[p];
      }
    }
  }

  void add(int span_x, int px, int py, int pz, double scale, Matrix<Dim>& block) const {
    const int triple = ((span_x * x_.num_pairs + px) * y_.num_pairs + py) * z_.num_pairs + pz;
    const double* sum = all_.data() + static_cast<std::size_t>(triple) * kComponents;
    for (int a = 0; a < Dim; ++a) {
      for (int b = a; b < Dim; ++b, ++sum) {
        block(a, b) += scale * *sum;
        if (a != b) block(b, a) += scale * *sum;
      }
    }
  }

  const TensorBlockAxis x_, y_, z_;
  const CurvatureBlocks<Dim>& blocks_;
  std::vector<double> along_x_, along_y_, all_;
};

}  // namespace

// Spans that are taps apart along the last axis share no control point: they go in parallel, one such
// set after the other, so that the order of additions does not depend on the threads.
template <int Dim>
void add_tensor_curvature(const std::array<TensorBlockAxis, Dim>& axes,
                          const CurvatureBlocks<Dim>& blocks, double scale,
                          BlockHessian<Dim>& hessian) {
  const int taps = axes[0].taps, num_slabs = axes[Dim - 1].num_spans;
  for (int colour = 0; colour < taps; ++colour) {
    const int count = (num_slabs - colour + taps - 1) / taps;
    if (count <= 0) continue;
    parallel_for(count, [&](std::int64_t n) {
      const int slab = colour + taps * static_cast<int>(n);
      SpanRow<Dim> row(axes, blocks);
      const int num_rows = Dim == 2 ? 1 : axes[1].num_spans;
      for (int r = 0; r < num_rows; ++r) {
        const int span_y = Dim == 2 ? slab : r, span_z = Dim == 2 ? 0 : slab;
        if (row.sum(span_y, span_z)) row.scatter(span_y, span_z, scale, hessian);
      }
    });
  }
}

template void add_tensor_curvature<2>(const std::array<TensorBlockAxis, 2>&,
                                      const CurvatureBlocks<2>&, double, BlockHessian<2>&);
template void add_tensor_curvature<3>(const std::array<TensorBlockAxis, 3>&,
                                      const CurvatureBlocks<3>&, double, BlockHessian<3>&);

}  // namespace crease
