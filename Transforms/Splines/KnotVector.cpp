#include "Transforms/Splines/KnotVector.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"

namespace crease {
namespace {

void check(int degree, const std::vector<double>& knots) {
  if (degree < 0 || degree > kMaxTensorDegree) {
    throw InvalidInput(
        message("KnotVector: the degree is ", degree, "; it must be 0 to ", kMaxTensorDegree, "."));
  }
  const int count = static_cast<int>(knots.size()), ends = degree + 1;
  if (count < 2 * ends) {
    throw InvalidInput(message("KnotVector: ", count, " knots; degree ", degree, " needs at least ",
                               2 * ends, ": both ends ", ends, " times."));
  }
  for (int k = 0; k < count; ++k) {
    if (!std::isfinite(knots[k]) || (k > 0 && knots[k] < knots[k - 1])) {
      throw InvalidInput(message("KnotVector: knot ", k, " is ", knots[k],
                                 k > 0 ? message(" after ", knots[k - 1]) : std::string(),
                                 "; knots must be finite and never decrease."));
    }
  }
  if (!(knots[ends - 1] == knots.front()) || !(knots[count - ends] == knots.back()) ||
      !(knots.front() < knots.back())) {
    throw InvalidInput(message("KnotVector: the first ", ends, " and the last ", ends,
                               " knots must be equal, and the ends differ; they are ",
                               knots.front(), " .. ", knots[ends - 1], " and ", knots[count - ends],
                               " .. ", knots.back(), "."));
  }
  for (int k = ends, run = 1; k + ends <= count; ++k) {
    run = knots[k] == knots[k - 1] ? run + 1 : 1;
    const bool inner = knots[k] > knots.front() && knots[k] < knots.back();
    if ((inner && run > std::max(degree, 1)) || (!inner && k + ends < count)) {
      throw InvalidInput(message("KnotVector: knot ", k, " repeats ", knots[k],
                                 " too often; inside degree ", degree, " allows ",
                                 std::max(degree, 1), " times, at the ends ", ends, "."));
    }
  }
}

}  // namespace

KnotVector::KnotVector(int degree, std::vector<double> knots)
    : degree_(degree), knots_(std::move(knots)) {
  check(degree_, knots_);
  const auto taps = static_cast<std::size_t>(degree_) + 1;
  ordinates_.resize(static_cast<std::size_t>(num_spans()) * taps);
  for (int s = 0; s < num_spans(); ++s) {
    if (span_length(s) == 0) continue;
    for (std::size_t r = 0; r < taps; ++r) {
      ordinates_[s * taps + r] = bezier_ordinates(std::span(knots_).subspan(s + r, taps + 1),
                                                  knots_[s + degree_], knots_[s + degree_ + 1]);
    }
  }
}

KnotVector KnotVector::even(int degree, double begin, double end, int spans) {
  if (spans < 1) {
    throw InvalidInput(message("KnotVector: ", spans, " spans; at least 1 is needed."));
  }
  std::vector<double> knots(static_cast<std::size_t>(std::max(degree, 0)), begin);
  for (int s = 0; s < spans; ++s) knots.push_back(begin + s * ((end - begin) / spans));
  knots.insert(knots.end(), static_cast<std::size_t>(std::max(degree, 0)) + 1, end);
  return {degree, std::move(knots)};
}

int KnotVector::find_span(double u) const {
  const auto first = knots_.begin() + degree_ + 1, last = knots_.end() - degree_ - 1;
  auto above = std::upper_bound(first, last, u);  // the knot that ends the span
  return static_cast<int>(above - knots_.begin()) - degree_ - 1;
}

BSplineSegment KnotVector::evaluate(int span, double u, int derivatives) const {
  const double length = span_length(span);
  const double s = std::clamp((u - span_begin(span)) / length, 0.0, 1.0);
  const BSplineSegment bernstein = bernstein_segment(degree_, s, derivatives);
  BSplineSegment result;
  for (int r = 0; r <= degree_; ++r) {
    const BezierJet jet = bezier_jet(ordinates(span, r), bernstein, length);
    result.value[r] = jet.value;
    result.first[r] = jet.first;
    result.second[r] = jet.second;
  }
  return result;
}

std::vector<double> KnotVector::greville_abscissae() const {
  std::vector<double> abscissae(static_cast<std::size_t>(num_functions()));
  for (int i = 0; i < num_functions(); ++i) {
    double sum = 0;
    for (int k = 1; k <= degree_; ++k) sum += knots_[i + k];
    abscissae[i] = degree_ > 0 ? sum / degree_ : 0.5 * (knots_[i] + knots_[i + 1]);
  }
  return abscissae;
}

int KnotVector::smoothness() const {
  int most = 0;
  for (int k = degree_ + 1, run = 0; k < num_functions(); ++k) {
    run = knots_[k] == knots_[k - 1] ? run + 1 : 1;
    most = std::max(most, run);
  }
  return degree_ - most;
}

KnotVector KnotVector::with_knot(double u) const {
  if (!(u > begin() && u < end())) {
    throw InvalidInput(
        message("KnotVector: a knot at ", u, " does not lie inside ", begin(), " .. ", end(), "."));
  }
  auto knots = knots_;
  knots.insert(std::upper_bound(knots.begin(), knots.end(), u), u);
  return {degree_, std::move(knots)};
}

Eigen::SparseMatrix<double, Eigen::RowMajor> KnotVector::insertion(double u) const {
  const int n = num_functions();
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(n + 1, n);
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j <= n; ++j) {
    // Share of the old coefficient j; the rest is that of j - 1.
    double share = 1;
    if (j >= n || u <= knots_[j]) {
      share = 0;
    } else if (u < knots_[j + degree_]) {
      share = (u - knots_[j]) / (knots_[j + degree_] - knots_[j]);
    }
    if (share > 0) entries.emplace_back(j, j, share);
    if (share < 1) entries.emplace_back(j, j - 1, 1 - share);
  }
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

KnotVector KnotVector::one_degree_less() const {
  std::vector<double> knots;
  for (std::size_t k = 1; k < knots_.size(); ++k) {
    if (knots_[k] == knots_[k - 1]) knots.push_back(knots_[k]);
  }
  return {degree_ - 1, std::move(knots)};
}

Eigen::SparseMatrix<double> KnotVector::collocation(const std::vector<double>& abscissae) const {
  Eigen::SparseMatrix<double> matrix(std::ssize(abscissae), num_functions());
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < abscissae.size(); ++row) {
    const int span = find_span(abscissae[row]);
    const auto segment = evaluate(span, abscissae[row], 0);
    for (int r = 0; r <= degree_; ++r) {
      entries.emplace_back(static_cast<int>(row), span + r, segment.value[r]);
    }
  }
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace crease
