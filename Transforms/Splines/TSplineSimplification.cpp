#include "Transforms/Splines/TSplineSimplification.h"

#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Transforms/Splines/TMeshNesting.h"

namespace crease {
namespace {

/// d-th derivatives, d = 0 .. degree, of a Bezier polynomial at one end of an interval of unit length, each
/// divided by d!: binomial(n, d) times the d-th difference of the ordinates.
std::vector<double> end_taylor(const BSplineSegment::Values& ordinates, int degree, bool at_end) {
  std::vector<double> differences(ordinates.begin(), ordinates.begin() + degree + 1);
  std::vector<double> taylor;
  double binomial = 1;
  for (int d = 0; d <= degree; ++d) {
    taylor.push_back(binomial * (at_end ? differences.back() : differences.front()));
    for (std::size_t k = 0; k + 1 < differences.size(); ++k) {
      differences[k] = differences[k + 1] - differences[k];
    }
    differences.pop_back();
    binomial = binomial * (degree - d) / (d + 1);
  }
  return taylor;
}

/// How much the map bends across its edges.
class JumpMeter {
 public:
  JumpMeter(const TSplineBasis& basis, const Eigen::Ref<const Eigen::MatrixXd>& control_points)
      : basis_(basis), control_points_(control_points) {}

  /// For the edge along `axis` through a middle point (mm along the axes): entry d is the largest jump of the
  /// d-th derivative across it, times h^d / d! with h the shorter of the elements on its sides.
  std::vector<double> jumps(int axis, const Vector<2>& middle, double begin, double end) const {
    const int across = 1 - axis, degree = basis_.degree();
    const double inside = 1e-3 * (end - begin);
    Vector<2> step = Vector<2>::Zero();
    step[across] = smallest_width(across);
    const auto& before = basis_.elements()[basis_.find_element(middle - step)];
    const auto& after = basis_.elements()[basis_.find_element(middle + step)];
    const double before_size = before.upper[across] - before.lower[across];
    const double after_size = after.upper[across] - after.lower[across];
    const double h = std::min(before_size, after_size);
    std::vector<double> result(static_cast<std::size_t>(degree) + 1, 0.0);
    for (int k = 0; k <= degree; ++k) {
      const double along = begin + inside + (end - begin - 2 * inside) * (k + 0.5) / (degree + 1);
      const Eigen::MatrixXd jump = taylor(after, axis, along, h / after_size, false) -
                                   taylor(before, axis, along, h / before_size, true);
      for (int d = 0; d <= degree; ++d) result[d] = std::max(result[d], jump.col(d).norm());
    }
    return result;
  }

 private:
  /// Less than any element's width, more than rounding.
  double smallest_width(int axis) const {
    double least = basis_.box().upper[axis] - basis_.box().lower[axis];
    for (const auto& e : basis_.elements()) least = std::min(least, e.upper[axis] - e.lower[axis]);
    return 1e-3 * least;
  }

  /// Column d: the map's d-th derivative across, over d!, for a step of `scale` times the element's size.
  Eigen::MatrixXd taylor(const TSplineBasis::Element& element, int axis, double along, double scale,
                         bool at_end) const {
    const int degree = basis_.degree(), across = 1 - axis;
    const double length = element.upper[axis] - element.lower[axis];
    const double s = std::clamp((along - element.lower[axis]) / length, 0.0, 1.0);
    const auto bernstein = bernstein_segment(degree, s, 0);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(control_points_.rows(), degree + 1);
    for (std::size_t n = 0; n < element.functions.size(); ++n) {
      const double value = bezier_jet(element.ordinates[n][axis], bernstein, length).value;
      const auto part = end_taylor(element.ordinates[n][across], degree, at_end);
      double power = value;
      for (int d = 0; d <= degree; ++d, power *= scale) {
        result.col(d) += power * part[d] * control_points_.col(element.functions[n]);
      }
    }
    return result;
  }

  const TSplineBasis& basis_;
  const Eigen::MatrixXd control_points_;
};

/// A piece of equal lines between neighbouring lines across, and how the map jumps there.
struct Piece {
  int axis;
  std::vector<int> lines;  // those of the equal ones that have the edge
  int begin, end;
  std::vector<double> jumps;
};

std::vector<Piece> pieces_of(const TSplineBasis& basis, const JumpMeter& meter) {
  const TMesh& mesh = basis.mesh();
  std::vector<Piece> pieces;
  for (int axis : {0, 1}) {
    const int across = 1 - axis, h = mesh.border_lines();
    for (int first = h; first < mesh.num_lines(across) - h;) {
      int last = first;
      while (mesh.knot(across, last + 1) == mesh.knot(across, first)) ++last;
      for (int k = 0; k + 1 < mesh.num_lines(axis); ++k) {
        Piece piece{axis, {}, k, k + 1, {}};
        for (int line = first; line <= last; ++line) {
          TPoint at;
          at[axis] = k;
          at[across] = line;
          if (mesh.has_edge(axis, at)) piece.lines.push_back(line);
        }
        const double begin = mesh.knot(axis, k), end = mesh.knot(axis, k + 1);
        if (piece.lines.empty() || !(begin < end)) continue;
        Vector<2> middle;
        middle[axis] = 0.5 * (begin + end);
        middle[across] = mesh.knot(across, first);
        piece.jumps = meter.jumps(axis, middle, begin, end);
        pieces.push_back(std::move(piece));
      }
      first = last + 1;
    }
  }
  return pieces;
}

/// What the map needs, completed; only the edges that stay decide between repeated lines.
TMesh needed_mesh(const TMesh& mesh, const std::vector<Piece>& pieces, double threshold) {
  TMesh result = mesh.without_inner_edges();
  for (const Piece& piece : pieces) {
    int needed = 0;
    for (int d = mesh.degree(); d >= 0; --d) {
      if (piece.jumps[d] > threshold) needed = mesh.degree() - d + 1;
    }
    for (int n = 0; n < std::min<int>(needed, static_cast<int>(piece.lines.size())); ++n) {
      result.add({piece.axis, piece.lines[n], piece.begin, piece.end});
    }
  }
  return analysis_suitable(rectangular(std::move(result)));
}

}  // namespace

TSplineApproximation simplified(const TSplineBasis& basis,
                                const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                                double tolerance) {
  if (control_points.cols() != basis.num_control_points() || !(tolerance > 0)) {
    throw InvalidInput(message("simplified: ", control_points.cols(),
                               " control points and a tolerance of ", tolerance,
                               " given; the basis has ", basis.num_control_points(),
                               " control points, and the tolerance must be positive."));
  }
  const auto pieces = pieces_of(basis, JumpMeter(basis, control_points));
  constexpr double kLeastThreshold = 1e-6;  // of the tolerance
  double threshold = tolerance;
  while (threshold > kLeastThreshold * tolerance) {
    TMesh mesh = needed_mesh(basis.mesh(), pieces, threshold);
    if (std::ssize(mesh.vertices()) >= basis.num_control_points()) break;
    TFit found = fit(mesh, basis.mesh(), control_points);
    if (found.max_error <= tolerance) {
      return {basis.on(mesh.without_empty_lines()), std::move(found.control_points),
              found.max_error};
    }
    threshold /= 4;
  }
  return {basis.on(basis.mesh()), control_points, 0};
}

}  // namespace crease
