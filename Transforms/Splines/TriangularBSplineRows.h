#pragma once

#include <array>
#include <vector>

#include "Core/Raster.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineCurvature.h"
#include "Transforms/Splines/TriangularBSplineGridKernels.h"

namespace crease {

class TriangularBSplineEvaluator;

/// Four rows of a raster, cut into runs. Rows of weights of strips: per run the control points whose
/// functions do not vanish, and their values at the run's samples.
struct RowBand {
  static constexpr int kRows = 4;
  std::array<int, kRows + 1> row_start{};  ///< of the runs
  std::vector<GridRun> runs;
  std::vector<int> points;
  std::vector<float> weights;
  std::vector<int> triangles;     ///< that have core runs, each once
  std::vector<int> strip_points;  ///< control points of all strips, each once
  BlockSamples blocks;            ///< one per block of 4 x 4 samples with any in the domain
};

/// Cuts a raster into runs and evaluates the strips: parallel over bands, 16 samples at a time.
std::vector<RowBand> make_row_bands(const TriangularBSplineBasis<2>& basis,
                                    const TriangularBSplineEvaluator& evaluator,
                                    const Raster<2>& raster);

}  // namespace crease
