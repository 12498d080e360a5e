#include "Images/PaddedPixels.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/RasterCheck.h"

namespace crease {
namespace {

/// The pixel whose value stands at index i of an axis of n pixels, mirrored at the outer centres.
int mirrored(int i, int n) {
  if (n == 1) return 0;
  const int period = 2 * n - 2;
  i = ((i % period) + period) % period;
  return i < n ? i : period - i;
}

constexpr float kLargest = 1e30f;

}  // namespace

template <int Dim>
PaddedPixels<Dim>::PaddedPixels(const std::array<int, Dim>& size) : size_(size) {
  double total = 1;
  for (int a = 0; a < Dim; ++a) {
    int length = size[a] + 2 * kPadding;
    if (a == 0) length = (length + 15) / 16 * 16;
    if (total * length >= std::numeric_limits<int>::max()) {
      throw InvalidInput("interpolation: the image has more than 2^31 pixels; crop or shrink it");
    }
    stride_[a] = static_cast<int>(total);
    first_ += std::int64_t{kPadding} * stride_[a];
    total *= length;
  }
  values_ = std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(total));
}

template <int Dim>
PaddedPixels<Dim>::PaddedPixels(const Image<float, Dim>& image) : PaddedPixels(image.size()) {
  check_interpolable(image);
  const std::int64_t tile = 64;
  parallel_for((num_rows() + tile - 1) / tile, [&](std::int64_t t) {
    for (std::int64_t r = t * tile; r < std::min(num_rows(), (t + 1) * tile); ++r) {
      std::ranges::copy(image.row(r), data() + row_offset(r));
    }
  });
  pad();
}

template <int Dim>
std::int64_t PaddedPixels<Dim>::num_rows() const {
  std::int64_t n = 1;
  for (int a = 1; a < Dim; ++a) n *= size_[a];
  return n;
}

template <int Dim>
void PaddedPixels<Dim>::pad() {
  const int end = stride_[1] - kPadding;  // the padding on the right fills the stride
  for (std::int64_t r = 0; r < num_rows(); ++r) {
    float* row = data() + row_offset(r);
    for (int i = -kPadding; i < 0; ++i) row[i] = row[mirrored(i, size_[0])];
    for (int i = size_[0]; i < end; ++i) row[i] = row[mirrored(i, size_[0])];
  }
  // Along further axes whole runs are copied: rows (j), then slices (k).
  for (int a = 1; a < Dim; ++a) {
    const int outer = (Dim == 3 && a == 1) ? size_[2] : 1;
    for (int o = 0; o < outer; ++o) {
      const std::int64_t plane = Dim == 3 && a == 1 ? o * std::int64_t{stride_[Dim - 1]} : 0;
      float* base = values_.get() + plane;
      if (a == 1 && Dim == 3) base += std::int64_t{kPadding} * stride_[Dim - 1];
      base += std::int64_t{kPadding} * stride_[a];
      for (int i = -kPadding; i < size_[a] + kPadding; ++i) {
        if (i >= 0 && i < size_[a]) continue;
        const float* from = base + std::int64_t{mirrored(i, size_[a])} * stride_[a];
        std::copy(from, from + stride_[a], base + std::int64_t{i} * stride_[a]);
      }
    }
  }
}

template <int Dim>
IntensityRange PaddedPixels<Dim>::range(const Mask<Dim>* mask, int reach) const {
  Mask<Dim> near;
  if (mask != nullptr) {
    if (mask->size() != size_) {
      throw InvalidInput("interpolation: the mask has another size than the image");
    }
    near = *mask;
    for (int a = 0; a < Dim; ++a) {
      const Mask<Dim> before = near;
      const std::int64_t step = a == 0 ? 1 : a == 1 ? size_[0] : std::int64_t{size_[0]} * size_[1];
      for (std::int64_t p = 0; p < std::ssize(before.values()); ++p) {
        const int i = static_cast<int>(p / step % size_[a]);
        const int from = std::max(-reach, -i), to = std::min(reach, size_[a] - 1 - i);
        std::uint8_t any = 0;
        for (int d = from; d <= to; ++d) any |= before.values()[p + d * step];
        near.values()[static_cast<std::size_t>(p)] = any;
      }
    }
  }
  IntensityRange found{std::numeric_limits<double>::infinity(),
                       -std::numeric_limits<double>::infinity()};
  for (std::int64_t r = 0; r < num_rows(); ++r) {
    const float* row = data() + row_offset(r);
    for (int i = 0; i < size_[0]; ++i) {
      if (mask != nullptr && near.row(r)[static_cast<std::size_t>(i)] == 0) continue;
      found.lower = std::min<double>(found.lower, row[i]);
      found.upper = std::max<double>(found.upper, row[i]);
    }
  }
  if (found.lower > found.upper) throw InvalidInput("interpolation: the mask is empty");
  return found;
}

template <int Dim>
void check_interpolable(const Image<float, Dim>& image) {
  check_raster(image.raster(), "interpolation");
  struct Bad {
    std::int64_t count = 0;
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    Bad& operator+=(const Bad& other) {
      count += other.count;
      first = std::min(first, other.first);
      return *this;
    }
  };
  const float* pixels = image.values().data();
  const std::int64_t block = 65536;
  const std::int64_t count = std::ssize(image.values());
  const Bad bad = parallel_sum((count + block - 1) / block, Bad{},
                               [&](std::int64_t b, Bad& sum) {
                                 int bad_here = 0;
                                 const std::int64_t end = std::min(count, (b + 1) * block);
                                 for (std::int64_t p = b * block; p < end; ++p) {
                                   bad_here += !(std::abs(pixels[p]) <= kLargest);
                                 }
                                 if (bad_here == 0) return;
                                 sum.count += bad_here;
                                 for (std::int64_t p = b * block; p < end; ++p) {
                                   if (std::abs(pixels[p]) <= kLargest) continue;
                                   sum.first = std::min(sum.first, p);
                                   return;
                                 }
                               },
                               1);
  if (bad.count == 0) return;
  const auto index = image.index(bad.first);
  std::ostringstream where;
  for (int a = 0; a < Dim; ++a) where << (a == 0 ? "" : ", ") << index[a];
  throw InvalidInput(message("interpolation: ", bad.count,
                             " pixels are not finite (or beyond 1e30), "
                             "the first at index (",
                             where.str(), "): ", pixels[bad.first], "; replace them"));
}

template class PaddedPixels<2>;
template class PaddedPixels<3>;
template void check_interpolable<2>(const Image<float, 2>&);
template void check_interpolable<3>(const Image<float, 3>&);

}  // namespace crease
