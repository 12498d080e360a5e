#include "Transforms/Splines/PowellSabinGrid.h"

#include <algorithm>

#include "Core/Cpu.h"
#include "Core/Parallel.h"
#include "Transforms/Splines/BPatchIndices.h"
#include "Transforms/Splines/PowellSabinRows.h"

namespace crease {
namespace {

constexpr int kDegree = 2;
constexpr int kStride = core_stride(kDegree);
constexpr int kPerCell = (kDegree + 1) * kStride;
constexpr int kCells = PowellSabinPatch::kNumCells;

// Where a coefficient or moment of X^i Y^j of component a stands among a cell's.
int place_of(int monomial, int a) {
  const auto [i, j] = kMonomials<2>[monomial];
  return j * kStride + a * (kDegree + 1) + i;
}

struct CellCoefficients final : BoundGrid<2>::Coefficients {
  std::vector<float> cells;  // kPerCell each
};

// Moments of the small triangles that the rows have met, each with a slot (-1: none yet).
struct CellMoments final : BoundGrid<2>::Accumulator {
  std::vector<int> slot;
  std::vector<int> cells;  // the slots' owners
  std::vector<double> moments;
};

}  // namespace

// The Taylor polynomial at the cell's centroid, in X = (i - centre_i) / size, Y = (j - centre_j) / size.
PowellSabinGrid::Cell PowellSabinGrid::cell_of(const PowellSabinPatch& patch, int number,
                                               const Raster<2>& raster) {
  const auto corners = patch.cell(number);
  const Point<2> centre = (corners[0] + corners[1] + corners[2]) / 3.0;
  const Point<2> index = raster.index(centre);
  double size = 0;
  for (int k = 0; k < 3; ++k) {
    const Vector<2> side = raster.index(corners[(k + 1) % 3]) - raster.index(corners[k]);
    size = std::max(size, side.norm());
  }
  const Matrix<2> step = size * raster.index_to_point();
  const auto jets = patch.evaluate(number, centre, 2);
  Cell cell{{index.x(), index.y(), 1.0 / size}, PowerForm(kMonomialCount, patch.num_functions())};
  for (int f = 0; f < patch.num_functions(); ++f) {
    const Vector<2> gradient = step.transpose() * jets.row(f).segment<2>(1).transpose();
    Matrix<2> hessian;
    hessian << jets(f, 3), jets(f, 4), jets(f, 4), jets(f, 5);
    const Matrix<2> second = step.transpose() * hessian * step;
    cell.form.col(f) << jets(f, 0), gradient, 0.5 * second(0, 0), second(0, 1), 0.5 * second(1, 1);
  }
  return cell;
}

PowellSabinGrid::PowellSabinGrid(const PowellSabinBasis& basis, const Raster<2>& raster)
    : raster_(raster), num_control_points_(basis.num_control_points()), avx2_(cpu_has_avx2()) {
  const auto count = std::ssize(basis.net().mesh.simplices);
  points_of_triangle_.resize(count);
  places_.resize(kCells * count);
  forms_.resize(kCells * count);
  parallel_for(count, [&](std::int64_t t) {
    const PowellSabinPatch& patch = basis.patch(static_cast<int>(t));
    points_of_triangle_[t].assign(patch.control_points().begin(), patch.control_points().end());
    for (int c = 0; c < kCells; ++c) {
      Cell cell = cell_of(patch, c, raster);
      places_[kCells * t + c] = cell.place;
      forms_[kCells * t + c] = std::move(cell.form);
    }
  });
  PowellSabinRows parts = make_powell_sabin_rows(basis, raster);
  rows_ = std::move(parts.rows);
  curvature_ = std::make_unique<CurvatureGroups>(basis.pattern(), std::move(parts.groups));
}

GridRow PowellSabinGrid::kernel_row(std::int64_t row) const {
  const auto of_row = runs(row);
  return {of_row.data(),
          static_cast<int>(of_row.size()),
          static_cast<int>(row),
          kDegree,
          places_.data(),
          nullptr,
          nullptr};
}

std::pair<int, int> PowellSabinGrid::row_range(std::int64_t row) const {
  const auto of_row = runs(row);
  if (of_row.empty()) return {0, 0};
  return {of_row.front().first, of_row.back().first + of_row.back().count};
}

void PowellSabinGrid::coverage(std::int64_t row, std::span<std::uint8_t> inside) const {
  std::fill_n(inside.begin(), raster_.size[0], std::uint8_t{0});
  for (const GridRun& run : runs(row)) {
    if (run.kind >= 0) std::fill_n(inside.begin() + run.first, run.count, std::uint8_t{1});
  }
}

std::unique_ptr<BoundGrid<2>::Coefficients> PowellSabinGrid::prepare(
    const Eigen::Ref<const ControlPoints<2>>& control_points) const {
  auto result = std::make_unique<CellCoefficients>();
  result->cells.assign(kPerCell * forms_.size(), 0.0f);
  Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, PowellSabinPatch::kMaxFunctions, 2> own;
  for (std::size_t cell = 0; cell < forms_.size(); ++cell) {
    if (cell % kCells == 0) {
      const auto points = points_of(cell);
      own.resize(std::ssize(points), 2);
      for (std::size_t k = 0; k < points.size(); ++k) {
        own.row(static_cast<Eigen::Index>(k)) = control_points.col(points[k]).transpose();
      }
    }
    const Eigen::Matrix<double, kMonomialCount, 2> coefficients = forms_[cell] * own;
    for (int m = 0; m < kMonomialCount; ++m) {
      for (int a = 0; a < 2; ++a) {
        result->cells[kPerCell * cell + place_of(m, a)] = static_cast<float>(coefficients(m, a));
      }
    }
  }
  return result;
}

void PowellSabinGrid::map_row(const Coefficients& coefficients, std::int64_t row,
                              const std::array<float*, 2>& out) const {
  const auto& c = static_cast<const CellCoefficients&>(coefficients);
  const auto kernel = avx2_ ? avx2::grid_map_row : baseline::grid_map_row;
  kernel(kernel_row(row), c.cells.data(), nullptr, out[0], out[1]);
}

std::unique_ptr<BoundGrid<2>::Accumulator> PowellSabinGrid::new_accumulator() const {
  auto sums = std::make_unique<CellMoments>();
  sums->slot.assign(forms_.size(), -1);
  return sums;
}

void PowellSabinGrid::add_row(Accumulator& sums, std::int64_t row,
                              const std::array<const float*, 2>& force) const {
  auto& s = static_cast<CellMoments&>(sums);
  for (const GridRun& run : runs(row)) {
    if (run.kind < 0 || s.slot[run.kind] >= 0) continue;
    s.slot[run.kind] = static_cast<int>(s.cells.size());
    s.cells.push_back(run.kind);
  }
  s.moments.resize(kPerCell * s.cells.size(), 0.0);
  const auto kernel = avx2_ ? avx2::grid_adjoint_row : baseline::grid_adjoint_row;
  kernel(kernel_row(row), force[0], force[1], s.slot.data(), s.moments.data(), nullptr, nullptr);
}

void PowellSabinGrid::finish(std::span<const std::unique_ptr<Accumulator>> sums,
                             Eigen::Ref<ControlPoints<2>> gradient) const {
  std::vector<double> moments(kPerCell * forms_.size(), 0.0);
  for (const auto& part : sums) {
    const auto& s = static_cast<const CellMoments&>(*part);
    for (std::size_t i = 0; i < s.cells.size(); ++i) {
      double* target = &moments[kPerCell * static_cast<std::size_t>(s.cells[i])];
      for (int k = 0; k < kPerCell; ++k) target[k] += s.moments[kPerCell * i + k];
    }
  }
  Eigen::Matrix<double, kMonomialCount, 2> by_monomial;
  for (std::size_t cell = 0; cell < forms_.size(); ++cell) {
    for (int m = 0; m < kMonomialCount; ++m) {
      for (int a = 0; a < 2; ++a) by_monomial(m, a) = moments[kPerCell * cell + place_of(m, a)];
    }
    const auto points = points_of(cell);
    for (std::size_t k = 0; k < points.size(); ++k) {
      gradient.col(points[k]) +=
          by_monomial.transpose() * forms_[cell].col(static_cast<Eigen::Index>(k));
    }
  }
}

}  // namespace crease
