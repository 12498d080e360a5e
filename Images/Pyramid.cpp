#include "Images/Pyramid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Images/SeparableFilter.h"

namespace crease {
namespace {

constexpr int kSmallestAxis = 16;  // shorter axes are not halved

template <int Dim>
std::array<bool, Dim> axes_to_halve(const Raster<Dim>& raster) {
  double finest = std::numeric_limits<double>::infinity();
  for (int a = 0; a < Dim; ++a) {
    if (raster.size[a] >= kSmallestAxis) finest = std::min(finest, raster.spacing[a]);
  }
  std::array<bool, Dim> halve{};
  for (int a = 0; a < Dim; ++a) {
    halve[a] = raster.size[a] >= kSmallestAxis && raster.spacing[a] < 1.5 * finest;
  }
  return halve;
}

template <int Dim>
void check_factors(const ShrinkFactors<Dim>& factors) {
  for (int f : factors) {
    if (f < 1 || (f & (f - 1)) != 0) {
      throw InvalidInput(message("shrink: a factor is ", f, "; factors are powers of two"));
    }
  }
}

/// Calls visit(coarse pixel, pixels covered by it) for all coarse pixels, on any thread.
template <typename Pixel, int Dim, typename Visit>
Image<Pixel, Dim> shrink_cells(const Image<Pixel, Dim>& image, const ShrinkFactors<Dim>& factors,
                               Visit&& visit) {
  check_factors(factors);
  Image<Pixel, Dim> result(shrink(image.raster(), factors));
  parallel_for(result.raster().num_rows(), [&](std::int64_t row) {
    std::vector<Pixel> covered;
    for (std::int64_t p = row * result.size()[0]; p < (row + 1) * result.size()[0]; ++p) {
      const auto index = result.index(p);
      std::array<int, 3> first{0, 0, 0}, end{1, 1, 1};
      for (int a = 0; a < Dim; ++a) {
        first[a] = index[a] * factors[a];
        end[a] = std::min(first[a] + factors[a], image.size()[a]);
      }
      covered.clear();
      for (int k = first[2]; k < end[2]; ++k) {
        for (int j = first[1]; j < end[1]; ++j) {
          const auto line = image.row(j + std::int64_t{k} * (Dim == 3 ? image.size()[1] : 0));
          covered.insert(covered.end(), line.begin() + first[0], line.begin() + end[0]);
        }
      }
      result.values()[static_cast<std::size_t>(p)] = visit(covered);
    }
  });
  return result;
}

}  // namespace

template <int Dim>
ShrinkFactors<Dim> shrink_factors(const Raster<Dim>& raster, int level) {
  ShrinkFactors<Dim> factors;
  factors.fill(1);
  Raster<Dim> coarse = raster;
  for (int l = 0; l < level; ++l) {
    const auto halve = axes_to_halve(coarse);
    ShrinkFactors<Dim> step;
    for (int a = 0; a < Dim; ++a) {
      step[a] = halve[a] ? 2 : 1;
      factors[a] *= step[a];
    }
    coarse = shrink(coarse, step);
  }
  return factors;
}

template <int Dim>
int num_pyramid_levels(const Raster<Dim>& raster, int smallest) {
  const int longest = *std::ranges::max_element(raster.size);
  return 1 + std::max(0, static_cast<int>(std::lround(std::log2(double(longest) / smallest))));
}

template <int Dim>
Raster<Dim> shrink(const Raster<Dim>& raster, const ShrinkFactors<Dim>& factors) {
  check_factors(factors);
  Raster<Dim> coarse = raster;
  Vector<Dim> centre;
  for (int a = 0; a < Dim; ++a) {
    coarse.size[a] = (raster.size[a] + factors[a] - 1) / factors[a];
    coarse.spacing[a] = raster.spacing[a] * factors[a];
    centre[a] = 0.5 * (factors[a] - 1);
  }
  coarse.origin = raster.point(centre);
  return coarse;
}

template <int Dim>
Image<float, Dim> shrink(const Image<float, Dim>& image, const ShrinkFactors<Dim>& factors) {
  constexpr std::array<float, 4> kWeights{0.125f, 0.375f, 0.375f, 0.125f};
  check_factors(factors);
  Image<float, Dim> result;
  for (int a = Dim - 1; a >= 0; --a) {
    for (int f = factors[a]; f > 1; f /= 2) {
      ShrinkFactors<Dim> step;
      step.fill(1);
      step[a] = 2;
      const Image<float, Dim>& finer = result.empty() ? image : result;
      result = filter_axis<Dim>(finer, a, kWeights, 1, 2, shrink(finer.raster(), step));
    }
  }
  return result.empty() ? image : result;
}

template <int Dim>
Mask<Dim> shrink_mask(const Mask<Dim>& mask, const ShrinkFactors<Dim>& factors) {
  return shrink_cells(mask, factors, [](const std::vector<std::uint8_t>& covered) {
    const auto set = std::ranges::count_if(covered, [](std::uint8_t v) { return v != 0; });
    return static_cast<std::uint8_t>(2 * set > std::ssize(covered));
  });
}

template <int Dim>
LabelImage<Dim> shrink_labels(const LabelImage<Dim>& labels, const ShrinkFactors<Dim>& factors) {
  return shrink_cells(labels, factors, [](std::vector<std::int32_t>& covered) {
    std::ranges::sort(covered);
    std::int32_t best = covered[0];
    std::size_t most = 0;
    for (std::size_t i = 0; i < covered.size();) {
      std::size_t j = i;
      while (j < covered.size() && covered[j] == covered[i]) ++j;
      if (j - i > most) {
        most = j - i;
        best = covered[i];
      }
      i = j;
    }
    return best;
  });
}

template <int Dim>
std::vector<Image<float, Dim>> make_pyramid(const Image<float, Dim>& image, int levels) {
  if (levels < 1) {
    throw InvalidInput(message("make_pyramid: ", levels, " levels; there must be at least one"));
  }
  std::vector<Image<float, Dim>> pyramid{image};
  for (int l = 1; l < levels; ++l) {
    pyramid.push_back(shrink(pyramid.back(), shrink_factors(pyramid.back().raster(), 1)));
  }
  return pyramid;
}

template ShrinkFactors<2> shrink_factors<2>(const Raster<2>&, int);
template ShrinkFactors<3> shrink_factors<3>(const Raster<3>&, int);
template int num_pyramid_levels<2>(const Raster<2>&, int);
template int num_pyramid_levels<3>(const Raster<3>&, int);
template Raster<2> shrink<2>(const Raster<2>&, const ShrinkFactors<2>&);
template Raster<3> shrink<3>(const Raster<3>&, const ShrinkFactors<3>&);
template Image<float, 2> shrink<2>(const Image<float, 2>&, const ShrinkFactors<2>&);
template Image<float, 3> shrink<3>(const Image<float, 3>&, const ShrinkFactors<3>&);
template Mask<2> shrink_mask<2>(const Mask<2>&, const ShrinkFactors<2>&);
template Mask<3> shrink_mask<3>(const Mask<3>&, const ShrinkFactors<3>&);
template LabelImage<2> shrink_labels<2>(const LabelImage<2>&, const ShrinkFactors<2>&);
template LabelImage<3> shrink_labels<3>(const LabelImage<3>&, const ShrinkFactors<3>&);
template std::vector<Image<float, 2>> make_pyramid<2>(const Image<float, 2>&, int);
template std::vector<Image<float, 3>> make_pyramid<3>(const Image<float, 3>&, int);

}  // namespace crease
