#include "Registration/InitialAlignment.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "Core/Error.h"
#include "Images/CubicBSplineInterpolator.h"
#include "Images/IntensityRange.h"
#include "Images/Moments.h"
#include "Images/Pyramid.h"
#include "Optimizers/GaussNewton.h"
#include "Optimizers/NelderMead.h"
#include "Registration/AffineObjective.h"
#include "Registration/ChannelMetric.h"
#include "Registration/SamplesInside.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/LandmarkFits.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"

namespace crease {
namespace {

template <int Dim>
AffineMap<Dim> translation(const Vector<Dim>& shift) {
  AffineMap<Dim> map;
  map.offset = shift;
  return map;
}

template <int Dim>
AffineMap<Dim> start_map(const Image<float, Dim>& fixed, const Image<float, Dim>& moving,
                         const Mask<Dim>* fixed_mask, const Mask<Dim>* moving_mask,
                         const Landmarks<Dim>& landmarks, const AlignmentOptions& options) {
  switch (options.start) {
    case AlignmentStart::kIdentity:
      return {};
    case AlignmentStart::kCentres:
      return translation<Dim>(geometric_centre(moving.raster()) - geometric_centre(fixed.raster()));
    case AlignmentStart::kMoments:
      return translation<Dim>(moments(moving, moving_mask).centre -
                              moments(fixed, fixed_mask).centre);
    case AlignmentStart::kLandmarks:
      if (options.search == AlignmentSearch::kAffine) {
        return fit_affine<Dim>(landmarks.fixed, landmarks.moving).affine_map();
      }
      if (options.search == AlignmentSearch::kSimilarity) {
        return fit_similarity<Dim>(landmarks.fixed, landmarks.moving).affine_map();
      }
      return fit_rigid<Dim>(landmarks.fixed, landmarks.moving).affine_map();
  }
  return {};
}

template <int Dim>
std::string box_text(const Box<Dim>& box) {
  const Eigen::IOFormat row(6, Eigen::DontAlignCols, ", ", ", ", "", "", "(", ")");
  return message(box.lower.transpose().format(row), " to ", box.upper.transpose().format(row),
                 " mm");
}

/// The metric of one level of the pyramid, in the frame of its search.
template <int Dim>
struct SearchLevel {
  std::shared_ptr<Metric<Dim>> metric;
  Point<Dim> centroid;
  double radius = 1;  // mm, centroid to the farthest corner
  double pixel = 1;   // mm
};

/// @param start  samples that it maps outside the moving image do not count.
template <int Dim>
SearchLevel<Dim> search_level(std::span<const ChannelLevels<Dim>> channels, std::size_t l,
                              const AffineMap<Dim>& start) {
  SearchLevel<Dim> search;
  const Raster<Dim>& raster = channels.front().levels[l].fixed.raster();
  std::vector<std::vector<float>> all_weights;
  Point<Dim> sum = Point<Dim>::Zero();
  double weight = 0;
  for (const ChannelLevels<Dim>& channel : channels) {
    const ImageLevel<Dim>& level = channel.levels[l];
    std::vector<float> weights = level.weights;
    keep_samples_inside<Dim>(raster, start, level.moving->raster(), 0, weights);
    for (std::int64_t r = 0; r < raster.num_rows(); ++r) {
      for (int i = 0; i < raster.size[0]; ++i) {
        const double w = weights[static_cast<std::size_t>(r * raster.size[0] + i)];
        sum += w * (raster.row_start(r) + i * raster.index_to_point().col(0));
        weight += w;
      }
    }
    all_weights.push_back(std::move(weights));
  }
  search.metric = channel_metric(channels, l, std::move(all_weights));
  search.centroid = sum / weight;
  const Box<Dim> box = raster.bounds();
  search.radius = (box.upper - search.centroid).cwiseMax(search.centroid - box.lower).norm();
  search.pixel = raster.spacing.minCoeff();
  return search;
}

/// The objective of a level; parameters of the map given.
template <int Dim>
struct SearchStart {
  AffineObjective<Dim> objective;
  Eigen::VectorXd parameters;
};

template <int Dim>
std::unique_ptr<Transform<Dim>> searched_transform(AlignmentSearch search,
                                                   const AffineMap<Dim>& map,
                                                   const Point<Dim>& centre) {
  switch (search) {
    case AlignmentSearch::kRigid:
      return std::make_unique<RigidTransform<Dim>>(map, centre);
    case AlignmentSearch::kSimilarity:
      return std::make_unique<SimilarityTransform<Dim>>(map, centre);
    default:
      return std::make_unique<AffineTransform<Dim>>(map, centre);
  }
}

template <int Dim>
SearchStart<Dim> search_start(const SearchLevel<Dim>& level, const AffineMap<Dim>& map,
                              AlignmentSearch search) {
  auto transform = searched_transform<Dim>(search, map, level.centroid);
  const Eigen::VectorXd parameters = transform->parameters();
  return {AffineObjective<Dim>(level.metric, std::move(transform), level.centroid, level.radius),
          parameters};
}

/// Steps that move the farthest corner by one pixel of the level: angles first, then translation.
template <int Dim>
Eigen::VectorXd unit_steps(const SearchLevel<Dim>& level) {
  constexpr int kAngles = Dim == 2 ? 1 : 3;
  Eigen::VectorXd steps(kAngles + Dim);
  steps.head(kAngles).setConstant(level.pixel / level.radius);
  steps.tail(Dim).setConstant(level.pixel);
  return steps;
}

/// Nelder-Mead from a few angles at the coarsest level.
template <int Dim>
AffineMap<Dim> coarse_search(const SearchLevel<Dim>& level, const AffineMap<Dim>& start,
                             bool try_angles, int& evaluations) {
  SearchStart<Dim> search = search_start(level, start, AlignmentSearch::kRigid);
  const Eigen::VectorXd units = unit_steps(level);
  const auto value = [&](const Eigen::VectorXd& parameters) {
    ++evaluations;
    try {
      return search.objective.evaluate(parameters, nullptr, nullptr);
    } catch (const SolverError&) {  // too little overlap
      return std::numeric_limits<double>::infinity();
    }
  };
  NelderMeadOptions options;
  options.size_tolerance = 0.05;
  options.max_evaluations = 500;
  std::vector<double> angles = {0};
  if (try_angles && Dim == 2) angles = {0, -30, -15, 15, 30};
  double best = std::numeric_limits<double>::infinity();
  Eigen::VectorXd best_parameters = search.parameters;
  for (double angle : angles) {
    Eigen::VectorXd from = search.parameters;
    from[0] += angle * std::numbers::pi / 180;
    if (!std::isfinite(value(from))) continue;
    const auto scaled = [&](const Eigen::VectorXd& u) {
      return value(from + units.cwiseProduct(u));
    };
    const NelderMeadResult found =
        nelder_mead(scaled, Eigen::VectorXd::Zero(from.size()),
                    Eigen::VectorXd::Constant(from.size(), 4.0), options);
    if (found.value < best) {
      best = found.value;
      best_parameters = from + units.cwiseProduct(found.x);
    }
  }
  return search.objective.map(best_parameters);
}

/// The cost as a function of unknowns that each move the frame by about a pixel per unit, whatever they are.
class ScaledObjective final : public ObjectiveFunction {
 public:
  ScaledObjective(ObjectiveFunction& inner, const Eigen::VectorXd& start)
      : inner_(inner), start_(start), unit_(start.size()) {
    for (Eigen::Index i = 0; i < unit_.size(); ++i) {
      unit_[i] = 1 / inner_.step_length(Eigen::VectorXd::Unit(unit_.size(), i));
    }
  }
  Eigen::VectorXd place(const Eigen::Ref<const Eigen::VectorXd>& u) const {
    return start_ + unit_.cwiseProduct(u);
  }
  Eigen::Index size() const override { return inner_.size(); }
  double evaluate(const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::VectorXd* gradient,
                  Eigen::SparseMatrix<double>* hessian) override {
    const double value = inner_.evaluate(place(u), gradient, hessian);
    if (std::isinf(value)) return value;
    if (gradient != nullptr) *gradient = gradient->cwiseProduct(unit_);
    if (hessian != nullptr) *hessian = unit_.asDiagonal() * *hessian * unit_.asDiagonal();
    return value;
  }
  bool preconditioner(const Eigen::Ref<const Eigen::VectorXd>& u,
                      Eigen::SparseMatrix<double>& matrix) override {
    evaluate(u, nullptr, &matrix);
    return true;
  }
  double step_length(const Eigen::Ref<const Eigen::VectorXd>& step) const override {
    return inner_.step_length(unit_.cwiseProduct(step));
  }

 private:
  ObjectiveFunction& inner_;
  Eigen::VectorXd start_, unit_;
};

std::unique_ptr<Optimizer> refining_optimizer(OptimizerKind kind) {
  OptimizerOptions stopping{.step_length = 1e-4, .max_iterations = 50};
  if (kind == OptimizerKind::kGaussNewton) {
    const GaussNewtonOptions options{.linear_solver = {.kind = LinearSolver::kDirect}};
    return std::make_unique<GaussNewton>(stopping, options);
  }
  stopping.max_iterations = 500;
  return make_optimizer(kind, stopping);
}

/// One level; keeps the start when nothing better is found.
template <int Dim>
AffineMap<Dim> refine(const SearchLevel<Dim>& level, const AffineMap<Dim>& start,
                      AlignmentSearch search_kind, OptimizerKind kind, int& evaluations) {
  SearchStart<Dim> search = search_start(level, start, search_kind);
  ScaledObjective objective(search.objective, search.parameters);
  const OptimizerResult found = refining_optimizer(kind)->minimize(
      objective, Eigen::VectorXd::Zero(search.parameters.size()));
  evaluations += found.num_evaluations;
  return search.objective.map(objective.place(found.x));
}

template <int Dim>
double value_at(const SearchLevel<Dim>& level, const AffineMap<Dim>& map) {
  SearchStart<Dim> search = search_start(level, map, AlignmentSearch::kAffine);
  return search.objective.evaluate(search.parameters, nullptr, nullptr);
}

template <int Dim>
double rotation_angle_deg(const Matrix<Dim>& linear) {
  const Eigen::JacobiSVD<Matrix<Dim>> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix<Dim> rotation = svd.matrixU() * svd.matrixV().transpose();
  if constexpr (Dim == 2) {
    return std::atan2(rotation(1, 0), rotation(0, 0)) * 180 / std::numbers::pi;
  }
  return std::acos(std::clamp((rotation.trace() - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
}

}  // namespace

template <int Dim>
void require_contrast(const Image<float, Dim>& image, const Mask<Dim>* mask,
                      const std::string& which) {
  const bool empty_mask =
      mask != nullptr && std::ranges::none_of(mask->values(), [](auto set) { return set != 0; });
  if (empty_mask) {
    throw InvalidInput(message("the mask of the ", which,
                               " image is empty: no pixel of the image counts; set those that "
                               "count to 1"));
  }
  const IntensityRange range = intensity_range(image, mask);
  if (!range.constant()) return;
  throw InvalidInput(message("the ", which, " image is constant (", range.lower, ")",
                             mask == nullptr ? "" : " inside its mask",
                             "; there is nothing to register"));
}

template <int Dim>
void require_overlap(const Raster<Dim>& fixed, const Raster<Dim>& moving,
                     const AffineMap<Dim>& map) {
  Box<Dim> mapped;
  const Box<Dim> box = fixed.bounds();
  for (int corner = 0; corner < (1 << Dim); ++corner) {
    Point<Dim> p = box.lower;
    for (int a = 0; a < Dim; ++a) {
      if (corner >> a & 1) p[a] = box.upper[a];
    }
    mapped.add(map(p));
  }
  if (mapped.intersects(moving.bounds())) return;
  throw InvalidInput(message("the images do not overlap: the fixed image covers ", box_text(mapped),
                             " after the start, the moving image ", box_text(moving.bounds()),
                             "; check their origins and directions, or start with --init centres"));
}

template <int Dim>
Alignment<Dim> align(std::span<const ChannelView<Dim>> channels, const Landmarks<Dim>& landmarks,
                     const AlignmentOptions& options, const RegistrationCallback& progress,
                     const GivenMap<Dim>& given) {
  if (channels.empty()) throw InvalidInput("alignment: there are no images");
  std::vector<Channel<Dim>> weighed;  // where weights compare
  std::vector<ChannelView<Dim>> pairs(channels.begin(), channels.end());
  if (channels.size() > 1 || channels.front().weight != 1) {
    weighed = normalised(channels);
    pairs = views(std::span<const Channel<Dim>>(weighed));
  }
  const ChannelView<Dim>& first = pairs.front();
  for (const ChannelView<Dim>& pair : pairs) {
    require_contrast(*pair.fixed, pair.fixed_mask, "fixed");
    require_contrast(*pair.moving, pair.moving_mask, "moving");
  }
  Alignment<Dim> result;
  result.map = given ? *given
                     : start_map(*first.fixed, *first.moving, first.fixed_mask, first.moving_mask,
                                 landmarks, options);
  for (const ChannelView<Dim>& pair : pairs) {
    require_overlap(pair.fixed->raster(), pair.moving->raster(), result.map);
  }
  const AffineMap<Dim> start = result.map;
  const int largest = std::ranges::max(first.fixed->size());
  const int levels =
      1 + std::max(0, static_cast<int>(std::lround(std::log2(std::max(1.0, largest / 64.0)))));
  const std::vector<ChannelLevels<Dim>> pyramids =
      channel_levels<Dim>(pairs, options.search == AlignmentSearch::kNone ? 1 : levels);
  const std::size_t num_levels = pyramids.front().levels.size();
  const auto level_at = [&](std::size_t l) { return search_level<Dim>(pyramids, l, result.map); };
  const SearchLevel<Dim> finest = level_at(num_levels - 1);
  const auto values_at = [&](const AffineMap<Dim>& map, double& value) {
    value = value_at(finest, map);
    return channel_values(finest.metric, value);
  };
  const auto before = values_at(start, result.report.metric_before);
  if (options.search != AlignmentSearch::kNone) {
    for (std::size_t l = 0; l < num_levels; ++l) {
      if (progress && !progress({.stage = "alignment",
                                 .level = static_cast<int>(l) + 1,
                                 .num_levels = static_cast<int>(num_levels)})) {
        break;
      }
      int& evaluations = result.report.evaluations;
      if (l == 0 && !given && options.start != AlignmentStart::kLandmarks) {
        result.map = coarse_search(level_at(l), result.map, options.try_angles, evaluations);
      }
      for (int again = 0; again < 2; ++again) {  // with the samples that are inside by then
        result.map =
            refine(level_at(l), result.map, options.search, options.optimizer, evaluations);
      }
    }
  }
  auto after = values_at(result.map, result.report.metric_after);
  if (result.report.metric_after > result.report.metric_before) {
    result.map = start;
    result.report.metric_after = result.report.metric_before;
    result.report.improved = false;
    after = before;
  }
  result.report.channels = channel_reports<Dim>(before, after);
  result.report.angle_deg = rotation_angle_deg<Dim>(result.map.linear);
  result.report.shift_mm = (result.map(finest.centroid) - finest.centroid).norm();
  return result;
}

template <int Dim>
Alignment<Dim> align(const Image<float, Dim>& fixed, const Image<float, Dim>& moving,
                     const Mask<Dim>* fixed_mask, const Mask<Dim>* moving_mask,
                     const Landmarks<Dim>& landmarks, const AlignmentOptions& options,
                     const RegistrationCallback& progress,
                     const std::optional<AffineMap<Dim>>& given, const MetricFactory<Dim>& metric) {
  const ChannelView<Dim> only{&fixed, &moving, fixed_mask, moving_mask, metric};
  return align<Dim>(std::span(&only, 1), landmarks, options, progress, given);
}

#define CREASE_INSTANTIATE(Dim)                                                                 \
  template Alignment<Dim> align<Dim>(std::span<const ChannelView<Dim>>, const Landmarks<Dim>&,  \
                                     const AlignmentOptions&, const RegistrationCallback&,      \
                                     const GivenMap<Dim>&);                                     \
  template Alignment<Dim> align<Dim>(const Image<float, Dim>&, const Image<float, Dim>&,        \
                                     const Mask<Dim>*, const Mask<Dim>*, const Landmarks<Dim>&, \
                                     const AlignmentOptions&, const RegistrationCallback&,      \
                                     const GivenMap<Dim>&, const MetricFactory<Dim>&);          \
  template void require_contrast<Dim>(const Image<float, Dim>&, const Mask<Dim>*,               \
                                      const std::string&);                                      \
  template void require_overlap<Dim>(const Raster<Dim>&, const Raster<Dim>&, const AffineMap<Dim>&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
