#pragma once

#include <functional>
#include <memory>

#include "Metrics/Metric.h"
#include "Metrics/MetricInput.h"
#include "Metrics/MutualInformation.h"

namespace crease {

/// Makes the metric of one level from that level's images.
template <int Dim>
using MetricFactory = std::function<std::unique_ptr<Metric<Dim>>(MetricInput<Dim>)>;

/// Sum of squared differences, the default metric: images of one kind, equal but for noise.
template <int Dim>
MetricFactory<Dim> ssd();

/// Normalised cross-correlation: intensities differ by a gain and an offset; `squared`: of either sign.
template <int Dim>
MetricFactory<Dim> ncc(bool squared = false);

/// Correlation within windows of 2 radius + 1 samples a side: gain and offset change from place to place.
template <int Dim>
MetricFactory<Dim> local_ncc(int radius = 4);

/// Mutual information, plain or normalised: images of different kinds.
template <int Dim>
MetricFactory<Dim> mutual_information(const MutualInformationOptions& options = {});

}  // namespace crease
