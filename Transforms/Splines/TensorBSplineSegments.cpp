#include "Transforms/Splines/TensorBSplineSegments.h"

namespace crease {
namespace {

using Values = BSplineSegment::Values;

/// From degree Degree - 1 to Degree.
template <int Degree>
void raise(const Values& lower, double s, Values& raised) {
  constexpr double kScale = 1.0 / Degree;
  raised[0] = kScale * (1 - s) * lower[0];
  for (int r = 1; r < Degree; ++r) {
    raised[r] = kScale * ((s + Degree - r) * lower[r - 1] + (1 + r - s) * lower[r]);
  }
  raised[Degree] = kScale * s * lower[Degree - 1];
}

/// Derivatives of the functions of a degree from what belongs to the degree below.
template <int Degree>
void differentiate(const Values& lower, Values& derivative) {
  derivative[0] = -lower[0];
  for (int r = 1; r < Degree; ++r) derivative[r] = lower[r - 1] - lower[r];
  derivative[Degree] = lower[Degree - 1];
}

/// values[d]: the functions of degree d at s, d = 0 .. Degree.
template <int Degree>
void values_of_all_degrees(double s, std::array<Values, kMaxTensorDegree + 1>& values) {
  if constexpr (Degree == 0) {
    values[0][0] = 1;
  } else {
    values_of_all_degrees<Degree - 1>(s, values);
    raise<Degree>(values[Degree - 1], s, values[Degree]);
  }
}

template <int Degree>
BSplineSegment segment(double s, int derivatives) {
  std::array<Values, kMaxTensorDegree + 1> values;
  values_of_all_degrees<Degree>(s, values);
  BSplineSegment result;
  for (int r = 0; r <= Degree; ++r) result.value[r] = values[Degree][r];
  if (derivatives > 0) differentiate<Degree>(values[Degree - 1], result.first);
  if constexpr (Degree > 1) {
    if (derivatives > 1) {
      Values below;
      differentiate<Degree - 1>(values[Degree - 2], below);
      differentiate<Degree>(below, result.second);
    }
  }
  return result;
}

}  // namespace

BSplineSegment bspline_segment(int degree, double s, int derivatives) {
  switch (degree) {
    case 1:
      return segment<1>(s, derivatives);
    case 2:
      return segment<2>(s, derivatives);
    case 3:
      return segment<3>(s, derivatives);
    case 4:
      return segment<4>(s, derivatives);
    default:
      return segment<5>(s, derivatives);
  }
}

BSplinePolynomials bspline_polynomials(int degree) {
  BSplinePolynomials c{};
  c[0][0] = 1;
  for (int d = 1; d <= degree; ++d) {
    BSplinePolynomials raised{};
    for (int t = 0; t < d; ++t) {
      for (int r = 0; r <= d; ++r) {
        const double left = r > 0 ? c[t][r - 1] : 0.0, right = r < d ? c[t][r] : 0.0;
        raised[t][r] += ((d - r) * left + (1 + r) * right) / d;
        raised[t + 1][r] += (left - right) / d;
      }
    }
    c = raised;
  }
  return c;
}

}  // namespace crease
