#include "Registration/ScalarStiffness.h"

namespace crease {
namespace {
constexpr double kSprings = 1e-6;  // of the mean stiffness: makes the minimum unique
}  // namespace

void add_springs(const HessianPattern& pattern, std::vector<double>& stiffness) {
  double sum = 0;
  for (int i = 0; i < pattern.size(); ++i) sum += stiffness[pattern.row_start()[i + 1] - 1];
  const double mean = pattern.size() > 0 ? sum / pattern.size() : 0;
  const double spring = (mean > 0 ? kSprings * mean : 1.0) * pattern.size() / pattern.num_entries();
  for (int i = 0; i < pattern.size(); ++i) {
    const int diagonal = pattern.row_start()[i + 1] - 1;
    for (int s = pattern.row_start()[i]; s < diagonal; ++s) {
      stiffness[s] -= spring;
      stiffness[diagonal] += spring;
      stiffness[pattern.row_start()[pattern.columns()[s] + 1] - 1] += spring;
    }
  }
}

Eigen::SparseMatrix<double> lower_triangle(const HessianPattern& pattern,
                                           const std::vector<double>& entries, int copies) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(copies * entries.size());
  for (int i = 0; i < pattern.size(); ++i) {
    for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s) {
      for (int a = 0; a < copies; ++a) {
        triplets.emplace_back(copies * i + a, copies * pattern.columns()[s] + a, entries[s]);
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(copies * pattern.size(), copies * pattern.size());
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace crease
