#include "Registration/Evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Core/Quantiles.h"
#include "Images/MakeInterpolator.h"
#include "Images/RasterCheck.h"
#include "Registration/EvaluationLabels.h"
#include "Transforms/LandmarkFits.h"

namespace crease {
namespace {

constexpr int kOutside = -1;  // label of samples that do not count

// Reads the image at the samples of the raster, at the nearest pixel; `outside` beyond it.
template <typename Pixel, int Dim>
Image<Pixel, Dim> on_raster(const Image<Pixel, Dim>& image, const Raster<Dim>& raster,
                            Pixel outside) {
  if (same_raster(image.raster(), raster)) return Image<Pixel, Dim>(raster, image.values());
  return resample_nearest(
      image, raster, [](const Point<Dim>& x) { return x; }, outside);
}

// The samples that count: in the mask, with a finite displacement.
template <int Dim>
Mask<Dim> counted_samples(const EvaluationInput<Dim>& input) {
  if (!input.displacement || input.displacement->empty()) {
    throw InvalidInput("evaluation: there is no displacement field to evaluate");
  }
  const DisplacementField<Dim>& u = *input.displacement;
  Mask<Dim> counted(u.raster(), 1);
  if (input.mask) counted = on_raster<std::uint8_t>(*input.mask, u.raster(), 0);
  std::int64_t bad = 0, first_bad = -1, count = 0;
  for (std::int64_t i = 0; i < u.raster().num_samples(); ++i) {
    if (!counted.values()[i]) continue;
    ++count;
    if (u.values()[i].allFinite()) continue;
    if (bad++ == 0) first_bad = i;
  }
  if (count == 0) throw InvalidInput("evaluation: the mask holds no sample of the displacement");
  if (bad > 0) {
    const auto index = u.index(first_bad);
    std::string place = std::to_string(index[0]);
    for (int a = 1; a < Dim; ++a) place += ", " + std::to_string(index[a]);
    throw InvalidInput(message("evaluation: the displacement is not finite at ", bad,
                               " sample(s), first at pixel (", place,
                               "); exclude them by a mask or mend the field"));
  }
  return counted;
}

template <int Dim>
JacobianEvaluation<Dim> evaluate_jacobian(const EvaluationInput<Dim>& input,
                                          const Mask<Dim>& counted) {
  const Image<float, Dim> det = input.determinants
                                    ? on_raster(*input.determinants, counted.raster(), 1.0f)
                                    : determinant_map(*input.displacement);
  JacobianEvaluation<Dim> result;
  result.minimum = std::numeric_limits<double>::infinity();
  result.maximum = -result.minimum;
  std::int64_t count = 0;
  for (std::int64_t i = 0; i < det.raster().num_samples(); ++i) {
    if (!counted.values()[i]) continue;
    const double d = det.values()[i];
    ++count;
    result.mean += d;
    result.folded += !(d > 0);
    result.maximum = std::max(result.maximum, d);
    if (d < result.minimum) {
      result.minimum = d;
      const auto index = det.index(i);
      Vector<Dim> at;
      for (int a = 0; a < Dim; ++a) at[a] = index[a];
      result.minimum_at = det.raster().point(at);
    }
  }
  result.mean /= static_cast<double>(count);
  result.folded_fraction = static_cast<double>(result.folded) / static_cast<double>(count);
  return result;
}

// |T(x) - truth(x)| per sample in mm; NaN where there is no truth.
template <int Dim>
std::vector<double> truth_errors(const DisplacementField<Dim>& u,
                                 const DisplacementField<Dim>& truth) {
  std::vector<double> errors(u.values().size());
  if (same_raster(u.raster(), truth.raster())) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      errors[i] = (u.values()[i] - truth.values()[i]).norm();
    }
    return errors;
  }
  const PointMap<Dim> true_map = displacement_map(truth);
  parallel_for(u.raster().num_rows(), [&](std::int64_t row) {
    const Point<Dim> start = u.raster().row_start(row);
    const Vector<Dim> step = u.raster().index_to_point().col(0);
    for (int i = 0; i < u.size()[0]; ++i) {
      const Point<Dim> x = start + i * step;
      errors[row * u.size()[0] + i] = (x + u.row(row)[i] - true_map(x)).norm();
    }
  });
  return errors;
}

template <typename Wanted>
ErrorStatistics statistics_where(const std::vector<double>& errors, const Wanted& wanted) {
  std::vector<double> chosen;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (std::isfinite(errors[i]) && wanted(i)) chosen.push_back(errors[i]);
  }
  return error_statistics(std::move(chosen));
}

double rotation_angle_deg(const Matrix<2>& r) {
  return std::atan2(r(1, 0), r(0, 0)) * 180 / std::numbers::pi;
}
double rotation_angle_deg(const Matrix<3>& r) {
  return std::acos(std::clamp((r.trace() - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
}

template <int Dim>
Point<Dim> mean(const std::vector<Point<Dim>>& points) {
  Point<Dim> sum = Point<Dim>::Zero();
  for (const auto& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

// The samples of one body, where the map brings them, and where the truth does (if it is known).
template <int Dim>
struct BodyPoints {
  std::vector<Point<Dim>> fixed, mapped, truth;
  std::vector<double> errors;
};

template <int Dim>
BodyEvaluation<Dim> evaluate_body(int label, const BodyPoints<Dim>& points) {
  BodyEvaluation<Dim> body;
  body.label = label;
  body.samples = std::ssize(points.fixed);
  const auto fit = fit_rigid<Dim>(points.fixed, points.mapped);
  const Point<Dim> center = mean(points.fixed);
  body.angle_deg = rotation_angle_deg(fit.rotation());
  body.shift_mm = fit.map(center) - center;
  double sum = 0;
  for (std::size_t i = 0; i < points.fixed.size(); ++i) {
    sum += (fit.map(points.fixed[i]) - points.mapped[i]).squaredNorm();
  }
  body.rms_nonrigidity_mm = std::sqrt(sum / static_cast<double>(body.samples));
  if (points.truth.size() == points.fixed.size()) {
    const auto true_fit = fit_rigid<Dim>(points.fixed, points.truth);
    body.error = error_statistics(points.errors);
    const Matrix<Dim> apart = true_fit.rotation().transpose() * fit.rotation();
    body.angle_error_deg = std::abs(rotation_angle_deg(apart));
    body.shift_error_mm = (fit.map(center) - true_fit.map(center)).norm();
  }
  return body;
}

template <int Dim>
std::vector<BodyEvaluation<Dim>> evaluate_bodies(const EvaluationInput<Dim>& input,
                                                 const LabelImage<Dim>& labels,
                                                 const std::vector<double>& errors) {
  constexpr std::size_t kFewestSamples = Dim + 1;
  std::map<int, BodyPoints<Dim>> bodies;
  const DisplacementField<Dim>& u = *input.displacement;
  const PointMap<Dim> true_map = input.truth ? displacement_map(*input.truth) : nullptr;
  for (std::int64_t i = 0; i < u.raster().num_samples(); ++i) {
    if (labels.values()[i] <= 0) continue;
    const auto index = u.index(i);
    Vector<Dim> at;
    for (int a = 0; a < Dim; ++a) at[a] = index[a];
    const Point<Dim> x = u.raster().point(at);
    BodyPoints<Dim>& body = bodies[labels.values()[i]];
    body.fixed.push_back(x);
    body.mapped.push_back(x + u.values()[i]);
    if (true_map && std::isfinite(errors[i])) {
      body.truth.push_back(true_map(x));
      body.errors.push_back(errors[i]);
    }
  }
  std::vector<BodyEvaluation<Dim>> result;
  for (const auto& [label, points] : bodies) {
    if (points.fixed.size() >= kFewestSamples) result.push_back(evaluate_body(label, points));
  }
  return result;
}

template <int Dim>
void evaluate_landmarks(const EvaluationInput<Dim>& input, Evaluation<Dim>& result) {
  const PointMap<Dim> map = input.map ? input.map : displacement_map(*input.displacement);
  for (int j = 0; j < input.landmarks.size(); ++j) {
    const Point<Dim>& p = input.landmarks.fixed[j];
    const double error = (map(p) - input.landmarks.moving[j]).norm();
    if (!std::isfinite(error)) {
      throw InvalidInput(message("evaluation: landmark ", j + 1, " at (", p.transpose(),
                                 ") mm lies outside the displacement field, ",
                                 describe(input.displacement->raster())));
    }
    result.landmark_errors_mm.push_back(error);
  }
  result.landmarks = error_statistics(result.landmark_errors_mm);
}

// Sums over pairs of values of two images.
struct Products {
  double count = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0, ssd = 0;
  void add(double x, double y) {
    ++count;
    a += x;
    b += y;
    aa += x * x;
    bb += y * y;
    ab += x * y;
    ssd += (x - y) * (x - y);
  }
  double ncc() const {
    const double variance_a = aa - a * a / count, variance_b = bb - b * b / count;
    const double product = variance_a * variance_b;
    return product > 0 ? (ab - a * b / count) / std::sqrt(product) : 0;
  }
};

template <int Dim>
MatchEvaluation evaluate_match(const EvaluationInput<Dim>& input, const Mask<Dim>& counted) {
  const Raster<Dim>& raster = counted.raster();
  const float missing = std::numeric_limits<float>::quiet_NaN();
  const auto identity = PointMap<Dim>([](const Point<Dim>& x) { return x; });
  const auto moving = make_interpolator(*input.moving);
  const auto fixed = same_raster(input.fixed->raster(), raster)
                         ? Image<float, Dim>(raster, input.fixed->values())
                         : resample(*make_interpolator(*input.fixed, InterpolationKind::kLinear),
                                    raster, identity, missing);
  const auto before = resample(*moving, raster, identity, missing);
  const auto after = resample(*moving, raster, row_map(*input.displacement), missing);
  Products products_before, products_after, all_after;
  for (std::int64_t i = 0; i < raster.num_samples(); ++i) {
    const double f = fixed.values()[i], b = before.values()[i], a = after.values()[i];
    if (!counted.values()[i] || !std::isfinite(f + a)) continue;
    all_after.add(f, a);
    if (!std::isfinite(b)) continue;
    products_before.add(f, b);
    products_after.add(f, a);
  }
  if (all_after.count == 0) {
    throw InvalidInput(message("evaluation: the fixed image, ", describe(input.fixed->raster()),
                               ", and the moving image, ", describe(input.moving->raster()),
                               ", share no sample with the displacement, ", describe(raster)));
  }
  MatchEvaluation match;
  const bool apart = products_before.count == 0;  // before
  if (apart) products_after = all_after;
  match.samples = static_cast<std::int64_t>(products_after.count);
  match.ssd_before = apart ? missing : products_before.ssd;
  match.ssd_after = products_after.ssd;
  match.ncc_before = apart ? missing : products_before.ncc();
  match.ncc_after = products_after.ncc();
  if (apart) {
    match.ssd_reduction_percent = missing;
  } else if (match.ssd_before > 0) {
    match.ssd_reduction_percent = 100 * (1 - match.ssd_after / match.ssd_before);
  }
  return match;
}

template <int Dim>
void evaluate_with_labels(const EvaluationInput<Dim>& input, const Mask<Dim>& counted,
                          const std::vector<double>& errors, Evaluation<Dim>& result) {
  const Raster<Dim>& raster = counted.raster();
  LabelImage<Dim> labels = on_raster(*input.labels, raster, std::int32_t{kOutside});
  if (!errors.empty()) {
    const auto distance = distance_to(border_samples(labels));
    const double pixel = raster.spacing.minCoeff();
    const auto within = [&](double pixels) {
      return statistics_where(errors, [&](std::size_t i) {
        return counted.values()[i] && distance.values()[i] / pixel + 0.5 <= pixels;
      });
    };
    result.error_within_3 = within(3);
    result.error_within_10 = within(10);
  }
  for (std::size_t i = 0; i < labels.values().size(); ++i) {
    if (!counted.values()[i]) labels.values()[i] = kOutside;
  }
  result.bodies = evaluate_bodies(input, labels, errors);
  if (!input.moving_labels) return;
  auto warped = resample_nearest(*input.moving_labels, raster, row_map(*input.displacement), 0);
  for (std::size_t i = 0; i < warped.values().size(); ++i) {
    if (labels.values()[i] == kOutside) warped.values()[i] = kOutside;
  }
  result.labels = compare_labels(labels, warped);
}

}  // namespace

ErrorStatistics error_statistics(std::vector<double> errors) {
  ErrorStatistics result;
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  result.count = std::ssize(errors);
  for (const double e : errors) {
    result.mean += e;
    result.rms += e * e;
  }
  result.mean /= static_cast<double>(errors.size());
  result.rms = std::sqrt(result.rms / static_cast<double>(errors.size()));
  result.median = interpolated_quantile(errors, 0.5);
  result.percentile_95 = interpolated_quantile(errors, 0.95);
  result.maximum = errors.back();
  return result;
}

template <int Dim>
Evaluation<Dim> evaluate(const EvaluationInput<Dim>& input) {
  const Mask<Dim> counted = counted_samples(input);
  Evaluation<Dim> result;
  for (const auto c : counted.values()) result.samples += c != 0;
  result.jacobian = evaluate_jacobian(input, counted);
  std::vector<double> errors;
  if (input.truth) {
    errors = truth_errors(*input.displacement, *input.truth);
    result.error = statistics_where(errors, [&](std::size_t i) { return counted.values()[i]; });
    if (result.error->count == 0) {
      throw InvalidInput(message("evaluation: the truth, ", describe(input.truth->raster()),
                                 ", shares no sample with the displacement, ",
                                 describe(counted.raster())));
    }
  }
  if (input.labels) evaluate_with_labels(input, counted, errors, result);
  if (!input.landmarks.empty()) evaluate_landmarks(input, result);
  if (input.fixed && input.moving) result.match = evaluate_match(input, counted);
  return result;
}

template Evaluation<2> evaluate<2>(const EvaluationInput<2>&);
template Evaluation<3> evaluate<3>(const EvaluationInput<3>&);

}  // namespace crease
