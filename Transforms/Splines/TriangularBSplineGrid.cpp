#include "Transforms/Splines/TriangularBSplineGrid.h"

#include <algorithm>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Transforms/Splines/TriangularBSplineEvaluator.h"

namespace crease {
namespace {

struct GridCoefficients final : BoundGrid<2>::Coefficients {
  std::vector<float> core;    // per triangle, power of Y and core_stride
  std::vector<float> points;  // x, y
};

// Sums of the triangles and control points that the rows have met, each with a slot (-1: none yet).
struct GridAccumulator final : BoundGrid<2>::Accumulator {
  struct alignas(64) PointSums {  // one line of the cache
    float x[8] = {}, y[8] = {};   // partial sums
  };

  const RowBand* band = nullptr;  // met last
  std::vector<int> patch_slot, point_slot;
  std::vector<int> patches, points;  // the slots' owners
  std::vector<double> moments;       // per slot, power of Y and core_stride
  std::vector<PointSums> sums;       // per slot

  static void add_slots(const std::vector<int>& met, std::vector<int>& slot,
                        std::vector<int>& owners) {
    for (int i : met) {
      if (slot[i] >= 0) continue;
      slot[i] = static_cast<int>(owners.size());
      owners.push_back(i);
    }
  }
};

// The triangle's used knots in index coordinates.
std::array<std::vector<Point<2>>, 3> clouds_in_index(const KnotNet<2>& net, int triangle,
                                                     const Raster<2>& raster) {
  std::array<std::vector<Point<2>>, 3> clouds;
  for (int j = 0; j < 3; ++j) {
    for (const auto& knot : net.clouds[net.mesh.simplices[triangle][j]]) {
      clouds[j].push_back(raster.index(knot));
    }
  }
  return clouds;
}

}  // namespace

TriangularBSplineGrid::TriangularBSplineGrid(const TriangularBSplineBasis<2>& basis,
                                             const TriangularBSplineEvaluator& evaluator,
                                             const Raster<2>& raster)
    : raster_(raster),
      degree_(basis.degree()),
      num_control_points_(basis.num_control_points()),
      avx2_(cpu_has_avx2()),
      bands_(make_row_bands(basis, evaluator, raster)) {
  const int count = static_cast<int>(basis.net().mesh.simplices.size());
  power_forms_.resize(count);
  patches_.resize(count);
  for (int t = 0; t < count; ++t) {
    const auto points = basis.control_points_of(t);
    points_of_triangle_.insert(points_of_triangle_.end(), points.begin(), points.end());
  }
  parallel_for(count, [&](std::int64_t t) {
    const auto clouds = clouds_in_index(basis.net(), static_cast<int>(t), raster);
    const BPatch<2>::Clouds spans = {clouds[0], clouds[1], clouds[2]};
    const Point<2> centre = (clouds[0][0] + clouds[1][0] + clouds[2][0]) / 3.0;
    const double size =
        std::max({(clouds[1][0] - clouds[0][0]).norm(), (clouds[2][0] - clouds[1][0]).norm(),
                  (clouds[0][0] - clouds[2][0]).norm()});
    power_forms_[t] = bpatch_power_form<2>(spans, degree_, centre, size);
    patches_[t] = {centre.x(), centre.y(), 1.0 / size};
  });
  std::vector<const BlockSamples*> parts;
  for (const RowBand& band : bands_) parts.push_back(&band.blocks);
  curvature_ = std::make_unique<CurvatureGroups>(curvature_groups(basis, parts));
  for (RowBand& band : bands_) band.blocks = {};
}

std::span<const GridRun> TriangularBSplineGrid::runs(std::int64_t row) const {
  const RowBand& band = bands_[row / RowBand::kRows];
  const auto r = static_cast<std::size_t>(row % RowBand::kRows);
  return std::span(band.runs).subspan(band.row_start[r], band.row_start[r + 1] - band.row_start[r]);
}

GridRow TriangularBSplineGrid::kernel_row(std::int64_t row) const {
  const RowBand& band = bands_[row / RowBand::kRows];
  const auto of_row = runs(row);
  return {of_row.data(),         static_cast<int>(of_row.size()),
          static_cast<int>(row), degree_,
          patches_.data(),       band.points.data(),
          band.weights.data()};
}

std::pair<int, int> TriangularBSplineGrid::row_range(std::int64_t row) const {
  const auto of_row = runs(row);
  if (of_row.empty()) return {0, 0};
  return {of_row.front().first, of_row.back().first + of_row.back().count};
}

void TriangularBSplineGrid::coverage(std::int64_t row, std::span<std::uint8_t> inside) const {
  std::fill_n(inside.begin(), raster_.size[0], std::uint8_t{0});
  for (const GridRun& run : runs(row)) {
    if (run.kind != GridRun::kOutside) {
      std::fill_n(inside.begin() + run.first, run.count, std::uint8_t{1});
    }
  }
}

std::unique_ptr<BoundGrid<2>::Coefficients> TriangularBSplineGrid::prepare(
    const Eigen::Ref<const ControlPoints<2>>& control_points) const {
  auto result = std::make_unique<GridCoefficients>();
  result->points.resize(2 * static_cast<std::size_t>(num_control_points_));
  for (int i = 0; i < num_control_points_; ++i) {
    for (int a = 0; a < 2; ++a)
      result->points[2 * i + a] = static_cast<float>(control_points(a, i));
  }
  const int stride = core_stride(degree_);
  const int functions = num_multi_indices<2>(degree_);
  result->core.assign(patches_.size() * per_triangle(), 0.0f);
  for (std::size_t t = 0; t < patches_.size(); ++t) {
    const int* points = &points_of_triangle_[t * functions];
    float* core = &result->core[t * per_triangle()];
    for (int m = 0; m < functions; ++m) {
      const auto [i, j] = kMonomials<2>[m];
      for (int a = 0; a < 2; ++a) {
        double sum = 0.0;
        for (int b = 0; b < functions; ++b) {
          sum += power_forms_[t](m, b) * control_points(a, points[b]);
        }
        core[j * stride + a * (degree_ + 1) + i] = static_cast<float>(sum);
      }
    }
  }
  return result;
}

void TriangularBSplineGrid::map_row(const Coefficients& coefficients, std::int64_t row,
                                    const std::array<float*, 2>& out) const {
  const auto& c = static_cast<const GridCoefficients&>(coefficients);
  const auto kernel = avx2_ ? avx2::grid_map_row : baseline::grid_map_row;
  kernel(kernel_row(row), c.core.data(), c.points.data(), out[0], out[1]);
}

std::unique_ptr<BoundGrid<2>::Accumulator> TriangularBSplineGrid::new_accumulator() const {
  auto sums = std::make_unique<GridAccumulator>();
  sums->patch_slot.assign(patches_.size(), -1);
  sums->point_slot.assign(num_control_points_, -1);
  return sums;
}

void TriangularBSplineGrid::add_row(Accumulator& sums, std::int64_t row,
                                    const std::array<const float*, 2>& force) const {
  auto& s = static_cast<GridAccumulator&>(sums);
  const RowBand& band = bands_[row / RowBand::kRows];
  if (s.band != &band) {
    s.band = &band;
    GridAccumulator::add_slots(band.triangles, s.patch_slot, s.patches);
    GridAccumulator::add_slots(band.strip_points, s.point_slot, s.points);
    s.moments.resize(s.patches.size() * per_triangle(), 0.0);
    s.sums.resize(s.points.size());
  }
  const auto kernel = avx2_ ? avx2::grid_adjoint_row : baseline::grid_adjoint_row;
  kernel(kernel_row(row), force[0], force[1], s.patch_slot.data(), s.moments.data(),
         s.point_slot.data(), s.sums.empty() ? nullptr : s.sums[0].x);
}

void TriangularBSplineGrid::finish(std::span<const std::unique_ptr<Accumulator>> sums,
                                   Eigen::Ref<ControlPoints<2>> gradient) const {
  std::vector<double> moments(patches_.size() * per_triangle(), 0.0);
  Eigen::Array<double, 8, Eigen::Dynamic> lanes_x =
      Eigen::Array<double, 8, Eigen::Dynamic>::Zero(8, num_control_points_);
  Eigen::Array<double, 8, Eigen::Dynamic> lanes_y = lanes_x;
  using Lanes = Eigen::Map<const Eigen::Array<float, 8, 1>>;
  for (const auto& part : sums) {
    const auto& s = static_cast<const GridAccumulator&>(*part);
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      lanes_x.col(s.points[i]) += Lanes(s.sums[i].x).cast<double>();
      lanes_y.col(s.points[i]) += Lanes(s.sums[i].y).cast<double>();
    }
    for (std::size_t i = 0; i < s.patches.size(); ++i) {
      double* target = &moments[static_cast<std::size_t>(s.patches[i]) * per_triangle()];
      const double* from = &s.moments[i * per_triangle()];
      for (int k = 0; k < per_triangle(); ++k) target[k] += from[k];
    }
  }
  gradient.row(0) += lanes_x.colwise().sum().matrix();
  gradient.row(1) += lanes_y.colwise().sum().matrix();
  const int stride = core_stride(degree_);
  const int functions = num_multi_indices<2>(degree_);
  Eigen::MatrixXd by_monomial(functions, 2);
  for (std::size_t t = 0; t < patches_.size(); ++t) {
    const double* of_patch = &moments[t * per_triangle()];
    for (int m = 0; m < functions; ++m) {
      const auto [i, j] = kMonomials<2>[m];
      by_monomial(m, 0) = of_patch[j * stride + i];
      by_monomial(m, 1) = of_patch[j * stride + degree_ + 1 + i];
    }
    const int* points = &points_of_triangle_[t * functions];
    for (int b = 0; b < functions; ++b) {
      gradient(0, points[b]) += power_forms_[t].col(b).dot(by_monomial.col(0));
      gradient(1, points[b]) += power_forms_[t].col(b).dot(by_monomial.col(1));
    }
  }
}

void TriangularBSplineGrid::add_curvature(const CurvatureBlocks<2>& blocks, double scale,
                                          BlockHessian<2>& hessian) const {
  curvature_->add(blocks, scale, hessian);
}

std::int64_t TriangularBSplineGrid::count_samples(bool core) const {
  std::int64_t count = 0;
  for (const RowBand& band : bands_) {
    for (const GridRun& run : band.runs) {
      if (core ? run.kind >= 0 : run.kind == GridRun::kStrip) count += run.count;
    }
  }
  return count;
}

std::int64_t TriangularBSplineGrid::num_core_samples() const { return count_samples(true); }
std::int64_t TriangularBSplineGrid::num_strip_samples() const { return count_samples(false); }

std::int64_t TriangularBSplineGrid::strip_bytes() const {
  std::size_t bytes = 0;
  for (const RowBand& band : bands_) {
    bytes += band.runs.size() * sizeof(GridRun) + band.points.size() * sizeof(int) +
             band.weights.size() * sizeof(float);
  }
  return static_cast<std::int64_t>(bytes);
}

}  // namespace crease
