#include "Transforms/Splines/PowellSabinRows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "Core/Parallel.h"
#include "Transforms/Splines/BlockSampling.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/KnotPolygon.h"
#include "Transforms/Splines/KnotRaster.h"

namespace crease {
namespace {

constexpr int kCells = PowellSabinPatch::kNumCells;
constexpr int kBlock = CurvatureBlocks<2>::kBlock;
constexpr int kNone = -1;

RasterRegion region_of(const std::array<Point<2>, 3>& corners, const Raster<2>& raster) {
  std::array<KnotPlane<2>, 3> sides;
  for (int k = 0; k < 3; ++k) sides[k] = side_through(corners[k], corners[(k + 1) % 3]);
  return {sides, raster};
}

// A triangle of the mesh on the raster.
struct Triangle {
  RasterRegion whole;
  std::array<RasterRegion, kCells> cells;
  int first_row = 0, last_row = -1;
  int sampling = 1;  // how far apart the samples may lie that stand for a block

  Triangle() = default;
  Triangle(const PowellSabinBasis& basis, int number, const Raster<2>& raster) {
    const auto corners = simplex_corners(basis.net().mesh, number);
    double low = std::numeric_limits<double>::infinity(), high = -low, longest = 0;
    for (int k = 0; k < 3; ++k) {
      const Point<2> a = raster.index(corners[k]), b = raster.index(corners[(k + 1) % 3]);
      low = std::min(low, a[1]);
      high = std::max(high, a[1]);
      longest = std::max(longest, (b - a).norm());
    }
    const double last = raster.size[1] - 1.0;
    first_row = static_cast<int>(std::clamp(std::floor(low), 0.0, last + 1));
    last_row = static_cast<int>(std::clamp(std::ceil(high), -1.0, last));
    const double altitude = signed_content<2>(corners) / raster.sample_volume() / longest;
    sampling = block_sampling(altitude / basis.degree());
    if (first_row > last_row) return;
    whole = region_of(corners, raster);
    for (int c = 0; c < kCells; ++c) cells[c] = region_of(basis.patch(number).cell(c), raster);
  }
};

// A sample that stands for a block, or a share of it.
struct Sample {
  int block, cell;
  Point<2> position;
  float root_share;
};

// A row of blocks.
struct Band {
  std::array<std::vector<GridRun>, kBlock> rows;
  std::vector<Sample> samples;
};

class BandBuilder {
 public:
  BandBuilder(const PowellSabinBasis& basis, const Raster<2>& raster,
              const std::vector<Triangle>& triangles, int band)
      : basis_(basis),
        raster_(raster),
        triangles_(triangles),
        tie_(kKnotTie * mesh_scale(basis.net().mesh)),
        step_(raster.index_to_point()),
        first_row_(band * kBlock),
        num_rows_(std::min(kBlock, raster.size[1] - first_row_)),
        cells_(static_cast<std::size_t>(num_rows_) * raster.size[0], kNone) {}

  // @param candidates  triangles that may reach the band, ascending.
  Band build(const std::vector<int>& candidates) {
    for (int t : candidates) {
      for (int r = 0; r < num_rows_; ++r) mark(t, r);
    }
    Band band;
    for (int r = 0; r < num_rows_; ++r) add_runs(r, band.rows[r]);
    const int num_blocks = (raster_.size[0] + kBlock - 1) / kBlock;
    choose_block_samples(
        num_rows_, raster_.size[0], [&](int r, int i) { return cell(r, i) != kNone; },
        [&](int r, int i) { return triangles_[cell(r, i) / kCells].sampling; },
        [&](int block, int r, int i, double share) {
          band.samples.push_back({first_row_ / kBlock * num_blocks + block, cell(r, i),
                                  position(r, i), static_cast<float>(std::sqrt(share))});
        });
    return band;
  }

 private:
  int& cell(int row, int i) { return cells_[static_cast<std::size_t>(row) * raster_.size[0] + i]; }
  Point<2> position(int row, int i) const {
    return raster_.origin + i * step_.col(0) + (first_row_ + row) * step_.col(1);
  }

  // A sample belongs to the first triangle and cell that claim it; rounding may keep one that lies between the
  // cells of its triangle from all of them.
  void mark(int t, int row) {
    const auto [first, last] = triangles_[t].whole.samples(first_row_ + row, tie_);
    if (first > last) return;
    for (int c = 0; c < kCells; ++c) {
      const auto [begin, end] = triangles_[t].cells[c].samples(first_row_ + row, tie_);
      for (int i = std::max(first, begin); i <= std::min(last, end); ++i) {
        if (cell(row, i) == kNone) cell(row, i) = kCells * t + c;
      }
    }
    for (int i = first; i <= last; ++i) {
      if (cell(row, i) != kNone) continue;
      cell(row, i) = kCells * t + basis_.patch(t).find_cell(position(row, i));
    }
  }

  void add_runs(int row, std::vector<GridRun>& runs) {
    int first = 0, end = raster_.size[0];
    while (first < end && cell(row, first) == kNone) ++first;
    while (end > first && cell(row, end - 1) == kNone) --end;
    while (first < end) {
      const int here = cell(row, first);
      GridRun run{first, 1, here == kNone ? int{GridRun::kOutside} : here, 0, 0, 0};
      while (first + run.count < end && cell(row, first + run.count) == here) ++run.count;
      runs.push_back(run);
      first += run.count;
    }
  }

  const PowellSabinBasis& basis_;
  const Raster<2>& raster_;
  const std::vector<Triangle>& triangles_;
  const double tie_;
  const Matrix<2> step_;
  const int first_row_, num_rows_;
  std::vector<int> cells_;  // row by row; kNone: outside, or not yet known
};

// One group per triangle of the mesh that holds samples for blocks.
std::vector<CurvatureGroups::Group> groups_of(const PowellSabinBasis& basis,
                                              const std::vector<Band>& bands) {
  std::vector<std::vector<const Sample*>> of_triangle(basis.net().mesh.simplices.size());
  for (const Band& band : bands) {
    for (const Sample& s : band.samples) of_triangle[s.cell / kCells].push_back(&s);
  }
  std::vector<int> triangles;
  for (std::size_t t = 0; t < of_triangle.size(); ++t) {
    if (!of_triangle[t].empty()) triangles.push_back(static_cast<int>(t));
  }
  std::vector<CurvatureGroups::Group> groups(triangles.size());
  parallel_for(std::ssize(triangles), [&](std::int64_t g) {
    const int t = triangles[g];
    const PowellSabinPatch& patch = basis.patch(t);
    const auto points = patch.control_points();
    groups[g].set_control_points({points.begin(), points.end()}, of_triangle[t].size());
    float* row = groups[g].weights.data();
    for (const Sample* s : of_triangle[t]) {
      groups[g].blocks.push_back(s->block);
      const auto values = patch.evaluate(s->cell % kCells, s->position, 0);
      for (Eigen::Index k = 0; k < values.rows(); ++k) {
        row[k] = s->root_share * static_cast<float>(values(k, 0));
      }
      row += groups[g].stride;
    }
  });
  return groups;
}

}  // namespace

PowellSabinRows make_powell_sabin_rows(const PowellSabinBasis& basis, const Raster<2>& raster) {
  std::vector<Triangle> triangles(basis.net().mesh.simplices.size());
  parallel_for(std::ssize(triangles), [&](std::int64_t t) {
    triangles[t] = Triangle(basis, static_cast<int>(t), raster);
  });
  const auto candidates = triangles_of_block_rows(triangles, raster.size[1]);
  std::vector<Band> bands(candidates.size());
  parallel_for(std::ssize(candidates), [&](std::int64_t b) {
    bands[b] = BandBuilder(basis, raster, triangles, static_cast<int>(b)).build(candidates[b]);
  });
  PowellSabinRows result;
  for (Band& band : bands) {
    for (auto& row : band.rows) {
      if (std::ssize(result.rows) < raster.size[1]) result.rows.push_back(std::move(row));
    }
  }
  result.groups = groups_of(basis, bands);
  return result;
}

}  // namespace crease
