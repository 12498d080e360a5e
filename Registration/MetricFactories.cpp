#include "Registration/MetricFactories.h"

#include "Metrics/LocalCorrelation.h"
#include "Metrics/NormalizedCrossCorrelation.h"
#include "Metrics/SumOfSquaredDifferences.h"

namespace crease {

template <int Dim>
MetricFactory<Dim> ssd() {
  return [](MetricInput<Dim> input) {
    return std::make_unique<SumOfSquaredDifferences<Dim>>(std::move(input));
  };
}

template <int Dim>
MetricFactory<Dim> ncc(bool squared) {
  return [squared](MetricInput<Dim> input) {
    return std::make_unique<NormalizedCrossCorrelation<Dim>>(std::move(input), squared);
  };
}

template <int Dim>
MetricFactory<Dim> local_ncc(int radius) {
  return [radius](MetricInput<Dim> input) {
    return std::make_unique<LocalCorrelation<Dim>>(std::move(input), radius);
  };
}

template <int Dim>
MetricFactory<Dim> mutual_information(const MutualInformationOptions& options) {
  return [options](MetricInput<Dim> input) {
    return std::make_unique<MutualInformation<Dim>>(std::move(input), options);
  };
}

#define CREASE_INSTANTIATE(Dim)                    \
  template MetricFactory<Dim> ssd<Dim>();          \
  template MetricFactory<Dim> ncc<Dim>(bool);      \
  template MetricFactory<Dim> local_ncc<Dim>(int); \
  template MetricFactory<Dim> mutual_information<Dim>(const MutualInformationOptions&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
