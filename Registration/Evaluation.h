#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "Images/Image.h"
#include "Images/Resample.h"
#include "Registration/Landmarks.h"

namespace crease {

/// Lengths in mm, summed up. Percentiles interpolate linearly between ranks.
struct ErrorStatistics {
  std::int64_t count = 0;
  double mean = 0, rms = 0, median = 0, percentile_95 = 0, maximum = 0;
};
ErrorStatistics error_statistics(std::vector<double> errors_mm);

/// How rigidly a map moves one body, over the samples of its label.
template <int Dim>
struct BodyEvaluation {
  int label = 0;
  std::int64_t samples = 0;
  double angle_deg = 0;  ///< of the best rigid fit; 2D: from the x to the y axis, 3D: not negative
  Vector<Dim> shift_mm = Vector<Dim>::Zero();  ///< of the body's centroid
  double rms_nonrigidity_mm = 0;               ///< distance from the best rigid fit
  /// Only with a truth: distance from it, and how far the best rigid fits of both are apart.
  std::optional<ErrorStatistics> error;
  double angle_error_deg = 0;
  double shift_error_mm = 0;
};

/// One label of both images after warping.
struct LabelOverlap {
  int label = 0;
  double dice = 0;
  /// The larger of the two directed 95 % distances between the borders; NaN if either image lacks
  /// it.
  double hausdorff_95_mm = 0;
};

/// det grad T over the samples.
template <int Dim>
struct JacobianEvaluation {
  double minimum = 0, maximum = 0, mean = 0;
  std::int64_t folded = 0;  ///< samples with det <= 0
  double folded_fraction = 0;
  Point<Dim> minimum_at = Point<Dim>::Zero();  ///< mm
};

/// Fixed against moving image, before (T = identity) and after, over the samples that are inside
/// the moving image both times. Images that do not overlap before have NaN there, and for the reduction.
struct MatchEvaluation {
  std::int64_t samples = 0;
  double ssd_before = 0, ssd_after = 0;  ///< sums of squared differences
  double ssd_reduction_percent = 0;
  double ncc_before = 0, ncc_after = 0;  ///< 0 where an image is constant
};

/// What was measured; parts without data are empty.
template <int Dim>
struct Evaluation {
  std::int64_t samples = 0;  ///< in the mask
  JacobianEvaluation<Dim> jacobian;
  std::optional<ErrorStatistics> error;            ///< against the truth
  std::optional<ErrorStatistics> error_within_3;   ///< within 3 pixels of a border between labels
  std::optional<ErrorStatistics> error_within_10;  ///< within 10 pixels
  std::optional<ErrorStatistics> landmarks;
  std::vector<double> landmark_errors_mm;
  std::vector<BodyEvaluation<Dim>> bodies;
  std::vector<LabelOverlap> labels;
  std::optional<MatchEvaluation> match;
};

/// What is known about a registration; null and empty parts are left out. Everything is evaluated
/// at the samples of the displacement. Truth and fixed image may lie on other rasters (read
/// linearly), labels and mask too (read at the nearest pixel); samples outside of them do not
/// count.
template <int Dim>
struct EvaluationInput {
  const DisplacementField<Dim>* displacement = nullptr;  ///< T(x) - x; needed
  PointMap<Dim> map = nullptr;                      ///< T itself, if there is more than the field
  const Image<float, Dim>* determinants = nullptr;  ///< det grad T; null: differences of the field
  const DisplacementField<Dim>* truth = nullptr;
  const LabelImage<Dim>* labels = nullptr;         ///< of the fixed image
  const LabelImage<Dim>* moving_labels = nullptr;  ///< of the moving image
  const Mask<Dim>* mask = nullptr;                 ///< of the fixed image
  const Image<float, Dim>* fixed = nullptr;
  const Image<float, Dim>* moving = nullptr;
  Landmarks<Dim> landmarks = {};
};

/// Errors, rigidity of bodies, overlap, folds and image match of a registration, whoever made it.
/// @throws InvalidInput when the displacement is missing, empty or not finite somewhere in the mask
/// (number and first pixel are named), the mask leaves nothing, images have nothing in common, or a
/// landmark lies outside the field.
template <int Dim>
Evaluation<Dim> evaluate(const EvaluationInput<Dim>& input);

/// x -> x + u(x), u interpolated linearly and continued by half a pixel beyond the outer samples.
/// Farther outside the result is NaN. The field must stay alive.
template <int Dim>
PointMap<Dim> displacement_map(const DisplacementField<Dim>& field);

/// det(I + grad u) at every sample, by central differences (one-sided at the border).
template <int Dim>
Image<float, Dim> determinant_map(const DisplacementField<Dim>& field);

extern template Evaluation<2> evaluate<2>(const EvaluationInput<2>&);
extern template Evaluation<3> evaluate<3>(const EvaluationInput<3>&);
extern template PointMap<2> displacement_map<2>(const DisplacementField<2>&);
extern template PointMap<3> displacement_map<3>(const DisplacementField<3>&);
extern template Image<float, 2> determinant_map<2>(const DisplacementField<2>&);
extern template Image<float, 3> determinant_map<3>(const DisplacementField<3>&);

}  // namespace crease
