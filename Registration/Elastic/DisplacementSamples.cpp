#include "Registration/Elastic/DisplacementSamples.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "Core/Parallel.h"
#include "Images/CubicBSplineInterpolator.h"
#include "Images/OpenCvView.h"
#include "Registration/RowTiles.h"

namespace crease {
namespace {

constexpr int kWidestStep = 4;
constexpr int kMarginNodes = 4;  // beyond the margin, so that what lies there is not seen

/// The nodes' displacements while they are found.
class Nodes {
 public:
  Nodes(const SplineTransform<2>& transform, const BoundGrid<2>& grid, int step, double margin_mm)
      : transform_(transform), grid_(grid), step_(step) {
    const Raster<2>& pixels = grid.raster();
    margin_ = static_cast<int>(std::ceil(margin_mm / (step * pixels.spacing.minCoeff())));
    border_ = margin_ + kMarginNodes;
    raster_ = pixels;
    raster_.spacing *= step;
    for (int a = 0; a < 2; ++a) raster_.size[a] = (pixels.size[a] - 1) / step + 2 + 2 * border_;
    raster_.origin = pixels.point(Vector<2>::Constant(-step * border_));
    known_ = Mask<2>(raster_);
    for (auto& component : components_) component = Image<float, 2>(raster_);
    fill_inside();
    fill_near();
    fill_far();
  }

  const std::array<Image<float, 2>, 2>& components() const { return components_; }

 private:
  Vector<2> beside_spline(const Point<2>& y) const { return transform_.affine()(y) - y; }
  /// Within the domain by rows, as the bound grid maps them.
  void fill_inside() {
    const Raster<2>& pixels = grid_.raster();
    const auto coefficients = grid_.prepare(transform_.control_points());
    parallel_for((pixels.size[1] - 1) / step_ + 1, [&](std::int64_t j) {
      const std::int64_t r = j * step_;
      const auto [begin, end] = grid_.row_range(r);
      std::vector<float> x(padded_row_size(pixels)), y(x.size());
      std::vector<std::uint8_t> inside(static_cast<std::size_t>(pixels.size[0]));
      grid_.map_row(*coefficients, r, {x.data(), y.data()});
      grid_.coverage(r, inside);
      for (int i = (begin + step_ - 1) / step_; i * step_ < end; ++i) {
        const auto pixel = static_cast<std::size_t>(i * step_);
        if (inside[pixel] == 0) continue;
        const Vector<2> beside = beside_spline(pixels.point({i * step_, static_cast<double>(r)}));
        const int row = static_cast<int>(j) + border_;
        components_[0](i + border_, row) = x[pixel] + static_cast<float>(beside[0]);
        components_[1](i + border_, row) = y[pixel] + static_cast<float>(beside[1]);
        known_(i + border_, row) = 1;
      }
    });
  }
  /// 0 where the displacement is known.
  cv::Mat unknown() const {
    cv::Mat mask(raster_.size[1], raster_.size[0], CV_8U);
    std::ranges::transform(known_.values(), mask.ptr(),
                           [](std::uint8_t known) -> std::uint8_t { return known ? 0 : 1; });
    return mask;
  }
  /// Around the domain by the transform's continuation.
  void fill_near() {
    cv::Mat distance;  // in nodes
    cv::distanceTransform(unknown(), distance, cv::DIST_L2, cv::DIST_MASK_5);
    parallel_for(raster_.size[1], [&](std::int64_t j) {
      const auto row = static_cast<int>(j);
      for (int i = 0; i < raster_.size[0]; ++i) {
        if (known_(i, row) || distance.at<float>(row, i) > static_cast<float>(margin_)) continue;
        const Point<2> y = raster_.point({i, static_cast<double>(row)});
        const Vector<2> d = transform_.map(y) - y;
        for (int a = 0; a < 2; ++a) components_[a](i, row) = static_cast<float>(d[a]);
        known_(i, row) = 1;
      }
    });
  }
  /// All others as their nearest neighbour that is known.
  void fill_far() {
    cv::Mat distance, labels;
    cv::distanceTransform(unknown(), distance, labels, cv::DIST_L2, cv::DIST_MASK_5,
                          cv::DIST_LABEL_PIXEL);
    const auto* label = labels.ptr<int>();
    std::vector<std::int32_t> place(known_.values().size() + 1);
    for (std::size_t n = 0; n < known_.values().size(); ++n) {
      if (known_.values()[n])
        place[static_cast<std::size_t>(label[n])] = static_cast<std::int32_t>(n);
    }
    for (std::size_t n = 0; n < known_.values().size(); ++n) {
      if (known_.values()[n]) continue;
      const auto nearest = static_cast<std::size_t>(place[static_cast<std::size_t>(label[n])]);
      for (auto& component : components_) component.values()[n] = component.values()[nearest];
    }
  }

  const SplineTransform<2>& transform_;
  const BoundGrid<2>& grid_;
  int step_, margin_ = 0, border_ = 0;
  Raster<2> raster_;
  Mask<2> known_;
  std::array<Image<float, 2>, 2> components_;
};

/// The largest distance between the interpolated displacement and the spline's own, in pixels.
double largest_error(const DisplacedInterpolator<2>::Components& components,
                     const SplineTransform<2>& transform, const BoundGrid<2>& grid) {
  const Raster<2>& pixels = grid.raster();
  const RowTiles<2> tiles(pixels);
  const auto coefficients = grid.prepare(transform.control_points());
  const Matrix<2> beside = transform.affine().linear - Matrix<2>::Identity();
  std::vector<double> largest(static_cast<std::size_t>(tiles.count()), 0.0);
  parallel_for(tiles.count(), [&](std::int64_t tile) {
    constexpr std::size_t kMargin = 16;
    const std::size_t size = padded_row_size(pixels) + 2 * kMargin;
    std::array<std::vector<float>, 2> exact, found;
    std::vector<float> flags(size);
    std::vector<std::uint8_t> inside(static_cast<std::size_t>(pixels.size[0]));
    for (int a = 0; a < 2; ++a) {
      exact[a].resize(size);
      found[a].resize(size);
    }
    tiles.for_each_row(tile, [&](std::int64_t r) {
      const auto [begin, end] = grid.row_range(r);
      if (begin >= end) return;
      grid.map_row(*coefficients, r, {exact[0].data(), exact[1].data()});
      grid.coverage(r, inside);
      MappedRow<2> row{.row = r, .begin = begin, .end = end};
      row.start = pixels.row_start(r);
      row.step = pixels.index_to_point().col(0);
      for (int a = 0; a < 2; ++a) {
        components[a]->evaluate_row(row, found[a].data() + kMargin, {}, flags.data() + kMargin);
      }
      const Vector<2> first = beside * row.start + transform.affine().offset;
      const Vector<2> step = beside * row.step;
      for (int i = begin; i < end; ++i) {
        if (inside[static_cast<std::size_t>(i)] == 0) continue;
        double squared = 0;
        for (int a = 0; a < 2; ++a) {
          const double own = exact[a][i] + first[a] + i * step[a];
          squared += std::pow(found[a][kMargin + i] - own, 2);
        }
        double& worst = largest[static_cast<std::size_t>(tile)];
        worst = std::max(worst, squared);
      }
    });
  });
  return std::sqrt(*std::ranges::max_element(largest)) / pixels.spacing.minCoeff();
}

}  // namespace

DisplacementSamples sample_displacement(const SplineTransform<2>& transform,
                                        const BoundGrid<2>& grid,
                                        const DisplacementSamplesOptions& options) {
  DisplacementSamples samples;
  for (int step = kWidestStep; step >= 1;) {
    {
      const Nodes nodes(transform, grid, step, options.margin_mm);
      for (int a = 0; a < 2; ++a) {
        samples.components[a] =
            std::make_shared<CubicBSplineInterpolator<2>>(nodes.components()[a]);
      }
    }
    samples.step = step;
    samples.largest_error = largest_error(samples.components, transform, grid);
    if (samples.largest_error <= options.tolerance) break;
    // The error at a crease is proportional to the step.
    do {
      step /= 2;
    } while (step > 1 && samples.largest_error * step > options.tolerance * samples.step);
  }
  return samples;
}

}  // namespace crease
