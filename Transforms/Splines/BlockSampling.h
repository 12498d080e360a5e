#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "Transforms/BoundGrid.h"

namespace crease {

/// Chooses the samples that stand for blocks of CurvatureBlocks along one row of blocks. A block is cut into squares
/// as wide as the functions in it allow; in each the covered sample nearest to the middle stands for all
/// that are covered.
/// @param num_rows, num_columns  of samples: at most kBlock rows.
/// @param covered   (row, column) -> whether the sample lies in the domain.
/// @param sampling  (row, column) -> how far apart samples may lie there: kBlock, kBlock / 2 or 1.
/// @param use       (block in the row, row, column, share) takes a sample and its share of the block.
template <typename Covered, typename Sampling, typename Use>
void choose_block_samples(int num_rows, int num_columns, const Covered& covered,
                          const Sampling& sampling, const Use& use) {
  constexpr int kBlock = CurvatureBlocks<2>::kBlock;
  for (int block = 0; block * kBlock < num_columns; ++block) {
    const int begin = block * kBlock, end = std::min(begin + kBlock, num_columns);
    int width = kBlock, all = 0;
    for (int r = 0; r < num_rows; ++r) {
      for (int c = begin; c < end; ++c) {
        if (!covered(r, c)) continue;
        ++all;
        width = std::min(width, sampling(r, c));
      }
    }
    if (all == 0) continue;
    for (int row = 0; row < num_rows; row += width) {
      for (int column = begin; column < end; column += width) {
        int count = 0, best_row = 0, best_column = 0;
        double least = std::numeric_limits<double>::infinity();
        for (int r = row; r < std::min(row + width, num_rows); ++r) {
          for (int c = column; c < std::min(column + width, end); ++c) {
            if (!covered(r, c)) continue;
            ++count;
            const double distance = std::hypot(r - row - width / 2.0, c - column - width / 2.0);
            if (distance >= least) continue;
            least = distance;
            best_row = r;
            best_column = c;
          }
        }
        if (count > 0) use(block, best_row, best_column, static_cast<double>(count) / all);
      }
    }
  }
}

/// The triangles, in their order, that each row of blocks has samples of.
/// @param triangles  with their first_row and last_row of samples; no rows where the first is the larger one.
template <typename Triangles>
std::vector<std::vector<int>> triangles_of_block_rows(const Triangles& triangles, int num_rows) {
  constexpr int kBlock = CurvatureBlocks<2>::kBlock;
  std::vector<std::vector<int>> found((num_rows + kBlock - 1) / kBlock);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (triangles[t].first_row > triangles[t].last_row) continue;
    for (int b = triangles[t].first_row / kBlock; b <= triangles[t].last_row / kBlock; ++b) {
      found[b].push_back(static_cast<int>(t));
    }
  }
  return found;
}

/// How far apart samples may lie where control points lie `spacing` samples apart.
inline int block_sampling(double spacing) {
  constexpr int kBlock = CurvatureBlocks<2>::kBlock, kHalf = kBlock / 2;
  return spacing >= kBlock ? kBlock : spacing >= kHalf ? kHalf : 1;
}

}  // namespace crease
