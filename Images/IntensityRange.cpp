#include "Images/IntensityRange.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "Core/Parallel.h"
#include "Core/Quantiles.h"
#include "Images/MaskedPixels.h"

namespace crease {
namespace {

constexpr std::int64_t kBlock = 1 << 18;  // pixels that one thread takes at a time

/// Unsigned numbers in the order of the floats they stand for.
std::uint32_t ordered(float v) {
  const auto bits = std::bit_cast<std::uint32_t>(v);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

/// Calls visit(pixel) for the pixels of block b that count.
template <int Dim, typename Visit>
void visit_block(const Image<float, Dim>& image, const Mask<Dim>* mask, std::int64_t b,
                 Visit&& visit) {
  const float* pixels = image.values().data();
  const std::uint8_t* set = mask == nullptr ? nullptr : mask->values().data();
  const std::int64_t end = std::min<std::int64_t>(std::ssize(image.values()), (b + 1) * kBlock);
  for (std::int64_t p = b * kBlock; p < end; ++p) {
    if (set == nullptr || set[p] != 0) visit(pixels[p]);
  }
}

template <int Dim>
std::int64_t num_blocks(const Image<float, Dim>& image) {
  return (std::ssize(image.values()) + kBlock - 1) / kBlock;
}

/// Pixels per upper 16 bits of their ordered representation.
struct Histogram {
  std::vector<std::int64_t> counts = std::vector<std::int64_t>(1 << 16);
  Histogram& operator+=(const Histogram& other) {
    for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
    return *this;
  }
};

struct Pixels {
  std::vector<float> values;
  Pixels& operator+=(const Pixels& other) {
    values.insert(values.end(), other.values.begin(), other.values.end());
    return *this;
  }
};

/// The pixel of the given rank: its bin from the histogram, then the right one of the bin's pixels.
template <int Dim>
double pixel_of_rank(const Image<float, Dim>& image, const Mask<Dim>* mask,
                     const Histogram& histogram, std::int64_t rank) {
  std::uint32_t bin = 0;
  while (rank >= histogram.counts[bin]) rank -= histogram.counts[bin++];
  Pixels in_bin = parallel_sum(
      num_blocks(image), Pixels{},
      [&](std::int64_t b, Pixels& sum) {
        visit_block(image, mask, b, [&](float v) {
          if (ordered(v) >> 16 == bin) sum.values.push_back(v);
        });
      },
      1);
  return static_cast<double>(value_of_rank(std::span(in_bin.values), rank));
}

}  // namespace

template <int Dim>
IntensityRange intensity_range(const Image<float, Dim>& image,
                               const std::type_identity_t<Mask<Dim>>* mask) {
  check_mask(image, mask, "intensity range");
  struct Range {
    float lower = std::numeric_limits<float>::infinity();
    float upper = -std::numeric_limits<float>::infinity();
    Range& operator+=(const Range& other) {
      lower = std::min(lower, other.lower);
      upper = std::max(upper, other.upper);
      return *this;
    }
  };
  const Range range = parallel_sum(
      num_blocks(image), Range{},
      [&](std::int64_t b, Range& sum) {
        visit_block(image, mask, b, [&](float v) {
          sum.lower = std::min(sum.lower, v);
          sum.upper = std::max(sum.upper, v);
        });
      },
      1);
  return {static_cast<double>(range.lower), static_cast<double>(range.upper)};
}

template <int Dim>
IntensityRange intensity_percentiles(const Image<float, Dim>& image,
                                     const std::type_identity_t<Mask<Dim>>* mask, double lower,
                                     double upper) {
  if (!(0 <= lower && lower <= upper && upper <= 100)) {
    throw InvalidInput(message("intensity percentiles: ", lower, " and ", upper,
                               " percent; they must ascend within 0 and 100"));
  }
  check_mask(image, mask, "intensity percentiles");
  const Histogram histogram = parallel_sum(
      num_blocks(image), Histogram{},
      [&](std::int64_t b, Histogram& sum) {
        visit_block(image, mask, b, [&](float v) { ++sum.counts[ordered(v) >> 16]; });
      },
      1);
  std::int64_t count = 0;
  for (std::int64_t c : histogram.counts) count += c;
  const auto rank = [&](double percent) { return nearest_rank(count, percent / 100); };
  return {pixel_of_rank(image, mask, histogram, rank(lower)),
          pixel_of_rank(image, mask, histogram, rank(upper))};
}

template IntensityRange intensity_range<2>(const Image<float, 2>&, const Mask<2>*);
template IntensityRange intensity_range<3>(const Image<float, 3>&, const Mask<3>*);
template IntensityRange intensity_percentiles<2>(const Image<float, 2>&, const Mask<2>*, double,
                                                 double);
template IntensityRange intensity_percentiles<3>(const Image<float, 3>&, const Mask<3>*, double,
                                                 double);

}  // namespace crease
