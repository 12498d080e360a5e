#pragma once

#include <cstdint>
#include <vector>

namespace crease {

/// Rows of samples that stand for all of them, so that a pass costs a share of a full one. Whole rows, since
/// passes work on whole rows: kernels stay vectorised, and what is left out costs nothing. The rows are cut into
/// strips of equal height, from each of which the seed chooses one; so sums over them, times the
/// number of strips' rows, vary little about those over all rows.
class RowSubset {
 public:
  /// All rows.
  RowSubset() = default;
  /// @param fraction  of the rows, in (0, 1]; at least one row is chosen. The same numbers choose the same rows
  /// everywhere.
  RowSubset(std::int64_t num_rows, double fraction, std::uint64_t seed);

  bool contains(std::int64_t row) const {
    return chosen_.empty() || chosen_[static_cast<std::size_t>(row)] != 0;
  }
  /// Sets the weights of samples in other rows to 0 and raises those in the chosen ones, so that their sum
  /// stays about the same. Rows follow each other in memory and are equally long.
  void apply(std::vector<float>& weights) const;

 private:
  std::vector<std::uint8_t> chosen_;  // empty: all
  float factor_ = 1;                  // all rows per chosen one
};

}  // namespace crease
