#include "Registration/EvaluationLabels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "Core/Parallel.h"

namespace crease {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// values[q] <- min over p of values[p] + (spacing (q - p))^2: the lower envelope of parabolas.
void transform_line(std::vector<float>& values, double spacing) {
  const int n = static_cast<int>(values.size());
  const double s2 = spacing * spacing;
  std::vector<int> apex;       // parabolas of the envelope, from left to right
  std::vector<double> starts;  // where each begins to be the lowest
  for (int q = 0; q < n; ++q) {
    if (values[q] == kFar) continue;
    double start = -std::numeric_limits<double>::infinity();
    while (!apex.empty()) {
      const int p = apex.back();
      start = 0.5 * ((values[q] - double(values[p])) / (s2 * (q - p)) + q + p);
      if (start > starts.back()) break;
      apex.pop_back();
      starts.pop_back();
      start = -std::numeric_limits<double>::infinity();
    }
    apex.push_back(q);
    starts.push_back(start);
  }
  if (apex.empty()) return;
  const std::vector<float> input = values;
  std::size_t k = 0;
  for (int q = 0; q < n; ++q) {
    while (k + 1 < apex.size() && starts[k + 1] < q) ++k;
    const double d = spacing * (q - apex[k]);
    values[q] = static_cast<float>(input[apex[k]] + d * d);
  }
}

// One call of transform_line for every line of samples along the axis.
template <int Dim>
void transform_axis(Image<float, Dim>& image, int axis) {
  std::int64_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= image.size()[a];
  const int length = image.size()[axis];
  auto& values = image.values();
  parallel_for(image.raster().num_samples() / length, [&](std::int64_t line) {
    const std::int64_t first = line / stride * stride * length + line % stride;
    std::vector<float> buffer(length);
    for (int i = 0; i < length; ++i) buffer[i] = values[first + i * stride];
    transform_line(buffer, image.raster().spacing[axis]);
    for (int i = 0; i < length; ++i) values[first + i * stride] = buffer[i];
  });
}

// Samples of the label with a face neighbour of another label, or on the image's rim.
template <int Dim>
Mask<Dim> surface(const LabelImage<Dim>& labels, int label) {
  Mask<Dim> result(labels.raster());
  for (std::size_t i = 0; i < labels.values().size(); ++i) {
    if (labels.values()[i] != label) continue;
    auto index = labels.index(static_cast<std::int64_t>(i));
    for (int a = 0; a < Dim; ++a) {
      for (const int step : {-1, 1}) {
        auto neighbour = index;
        neighbour[a] += step;
        const bool inside = neighbour[a] >= 0 && neighbour[a] < labels.size()[a];
        if (!inside || labels[neighbour] != label) result.values()[i] = 1;
      }
    }
  }
  return result;
}

// 95 % of the distances from one surface to the other, mm.
template <int Dim>
double directed_95(const Mask<Dim>& from, const Image<float, Dim>& distance) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < from.values().size(); ++i) {
    if (from.values()[i]) distances.push_back(distance.values()[i]);
  }
  return error_statistics(std::move(distances)).percentile_95;
}

template <int Dim>
LabelOverlap compare_label(const LabelImage<Dim>& a, const LabelImage<Dim>& b, int label) {
  std::int64_t in_a = 0, in_b = 0, in_both = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i) {
    const bool here = a.values()[i] == label, there = b.values()[i] == label;
    in_a += here;
    in_b += there;
    in_both += here && there;
  }
  LabelOverlap overlap;
  overlap.label = label;
  overlap.dice = 2.0 * static_cast<double>(in_both) / static_cast<double>(in_a + in_b);
  if (in_a == 0 || in_b == 0) {
    overlap.hausdorff_95_mm = std::numeric_limits<double>::quiet_NaN();
    return overlap;
  }
  const Mask<Dim> surface_a = surface(a, label), surface_b = surface(b, label);
  overlap.hausdorff_95_mm = std::max(directed_95(surface_a, distance_to(surface_b)),
                                     directed_95(surface_b, distance_to(surface_a)));
  return overlap;
}

}  // namespace

template <int Dim>
Image<float, Dim> distance_to(const Mask<Dim>& set) {
  Image<float, Dim> result(set.raster());
  auto& values = result.values();
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = set.values()[i] ? 0 : kFar;
  for (int a = 0; a < Dim; ++a) transform_axis(result, a);
  for (float& value : values) value = std::sqrt(value);
  return result;
}

template <int Dim>
Mask<Dim> border_samples(const LabelImage<Dim>& labels) {
  Mask<Dim> result(labels.raster());
  std::size_t stride = 1;
  for (int a = 0; a < Dim; ++a) {
    for (std::size_t i = 0; i + stride < labels.values().size(); ++i) {
      const bool last = labels.index(static_cast<std::int64_t>(i))[a] + 1 == labels.size()[a];
      if (!last && labels.values()[i] != labels.values()[i + stride]) {
        result.values()[i] = result.values()[i + stride] = 1;
      }
    }
    stride *= static_cast<std::size_t>(labels.size()[a]);
  }
  return result;
}

template <int Dim>
std::vector<LabelOverlap> compare_labels(const LabelImage<Dim>& a, const LabelImage<Dim>& b) {
  std::set<int> labels(a.values().begin(), a.values().end());
  labels.insert(b.values().begin(), b.values().end());
  std::vector<LabelOverlap> result;
  for (const int label : labels) {
    if (label > 0) result.push_back(compare_label(a, b, label));
  }
  return result;
}

template Image<float, 2> distance_to<2>(const Mask<2>&);
template Image<float, 3> distance_to<3>(const Mask<3>&);
template Mask<2> border_samples<2>(const LabelImage<2>&);
template Mask<3> border_samples<3>(const LabelImage<3>&);
template std::vector<LabelOverlap> compare_labels<2>(const LabelImage<2>&, const LabelImage<2>&);
template std::vector<LabelOverlap> compare_labels<3>(const LabelImage<3>&, const LabelImage<3>&);

}  // namespace crease
