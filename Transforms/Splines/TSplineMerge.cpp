#include "Transforms/Splines/TSplineMerge.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "Core/Error.h"
#include "Transforms/Splines/TMeshNesting.h"

namespace crease {
namespace {

void check(const TSplineBasis& first, Eigen::Index first_rows, Eigen::Index first_columns,
           const TSplineBasis& second, Eigen::Index second_rows, Eigen::Index second_columns,
           int axis, int smoothness) {
  if (first.degree() != second.degree() || axis < 0 || axis > 1 || smoothness < 0 ||
      smoothness >= first.degree()) {
    throw InvalidInput(
        message("merged: degrees ", first.degree(), " and ", second.degree(), ", axis ", axis,
                ", smoothness ", smoothness,
                "; the degrees must be equal, the axis 0 or 1 and the smoothness less "
                "than the degree."));
  }
  if (first_columns != first.num_control_points() ||
      second_columns != second.num_control_points() || first_rows != second_rows) {
    throw InvalidInput("merged: the control points do not fit the patches.");
  }
  const auto &a = first.box(), &b = second.box();
  const double size = (a.upper - a.lower).maxCoeff();
  const int other = 1 - axis;
  const double miss = std::max(
      {(a.origin - b.origin).norm(), std::abs(a.upper[axis] - b.lower[axis]),
       std::abs(a.lower[other] - b.lower[other]), std::abs(a.upper[other] - b.upper[other])});
  if (miss > 1e-9 * size || !a.direction.isApprox(b.direction, 1e-9)) {
    throw InvalidInput(message("merged: the patches do not share an edge across axis ", axis,
                               ": their places differ by ", miss, " mm."));
  }
}

/// All lines of both, repeated ones as often as the one that has more of them.
std::vector<double> united(const std::vector<double>& a, const std::vector<double>& b) {
  const double slack = 1e-9 * (a.back() - a.front());
  std::vector<double> lines;
  std::size_t i = 0, k = 0;
  while (i < a.size() || k < b.size()) {
    const bool both = i < a.size() && k < b.size() && std::abs(a[i] - b[k]) <= slack;
    const bool from_a = both || k == b.size() || (i < a.size() && a[i] < b[k]);
    lines.push_back(from_a ? a[i] : b[k]);
    i += from_a;
    k += both || !from_a;
  }
  return lines;
}

/// Two meshes on common lines across the axis, side by side on one list of lines along it.
class Seam {
 public:
  Seam(const TMesh& first, const TMesh& second, int axis)
      : axis_(axis), h_(first.border_lines()), degree_(first.degree()) {
    const auto across = united(first.lines(1 - axis), second.lines(1 - axis));
    const auto spread = [&](const TMesh& mesh) {
      std::array<std::vector<double>, 2> lines;
      lines[axis] = mesh.lines(axis);
      lines[1 - axis] = across;
      return mesh.on_lines(lines);
    };
    sides_ = {spread(first), spread(second)};
  }

  const TMesh& side(int s) const { return sides_[s]; }
  int lines_before() const { return sides_[0].num_lines(axis_) - h_; }

  /// The mesh whose common line stands `copies` times. With 2 h = degree + 1 copies the patches are strangers:
  /// each keeps to its own h lines. With fewer the lines across pass all of them.
  TMesh joined(int copies) const {
    const bool strangers = copies > degree_;
    const int before = lines_before(), behind = before + copies;
    std::array<std::vector<double>, 2> lines;
    const auto &a = sides_[0].lines(axis_), &b = sides_[1].lines(axis_);
    lines[axis_].assign(a.begin(), a.end() - h_);
    lines[axis_].insert(lines[axis_].end(), static_cast<std::size_t>(copies), a.back());
    lines[axis_].insert(lines[axis_].end(), b.begin() + h_, b.end());
    lines[1 - axis_] = sides_[0].lines(1 - axis_);
    const int num_along = static_cast<int>(lines[axis_].size());
    const int num_across = static_cast<int>(lines[1 - axis_].size());

    std::vector<TSegment> segments;
    for (int k = 0; k < copies; ++k) segments.push_back({1 - axis_, before + k, 0, num_across - 1});
    for (int k = 0; k < h_; ++k) {
      segments.push_back({axis_, k, 0, num_along - 1});
      segments.push_back({axis_, num_across - 1 - k, 0, num_along - 1});
    }
    for (int s : {0, 1}) {
      // Line k of a side along the axis; those at the seam become its first or last copy.
      const auto place = [&](int k) {
        if (s == 0) return k < before ? k : (strangers ? before + h_ - 1 : behind - 1);
        return k >= h_ ? behind + k - h_ : (strangers ? before + h_ : before);
      };
      for (const TSegment& e : sides_[s].segments()) {
        if (e.axis == axis_) {
          segments.push_back({e.axis, e.line, place(e.begin), place(e.end)});
        } else if (s == 0 ? e.line < before : e.line >= h_) {
          segments.push_back({e.axis, place(e.line), e.begin, e.end});
        }
      }
    }
    return {degree_, std::move(lines), segments};
  }

  /// Control points of the patches in the order of joined(degree + 1).
  Eigen::MatrixXd control_points(const TMesh& strangers, const Eigen::MatrixXd& of_first,
                                 const Eigen::MatrixXd& of_second) const {
    const auto vertices = strangers.vertices();
    Eigen::MatrixXd result(of_first.rows(), std::ssize(vertices));
    std::array<Eigen::Index, 2> next = {0, 0};
    for (std::size_t n = 0; n < vertices.size(); ++n) {
      // Either side's vertices come in the same order here as there.
      const bool second = vertices[n][axis_] >= lines_before() + h_;
      result.col(n) = second ? of_second.col(next[1]++) : of_first.col(next[0]++);
    }
    return result;
  }

 private:
  int axis_, h_, degree_;
  std::vector<TMesh> sides_;
};

}  // namespace

TSplineApproximation merged(const TSplineBasis& first,
                            const Eigen::Ref<const Eigen::MatrixXd>& first_control_points,
                            const TSplineBasis& second,
                            const Eigen::Ref<const Eigen::MatrixXd>& second_control_points,
                            int axis, int smoothness) {
  check(first, first_control_points.rows(), first_control_points.cols(), second,
        second_control_points.rows(), second_control_points.cols(), axis, smoothness);
  const int degree = first.degree();
  const Seam seam(first.mesh(), second.mesh(), axis);
  const TMesh strangers = seam.joined(degree + 1);
  const TMesh one = analysis_suitable(seam.joined(degree - smoothness));
  TFit found = fit(one, strangers,
                   seam.control_points(strangers, first_control_points, second_control_points));
  return {first.on(one), std::move(found.control_points), found.max_error};
}

}  // namespace crease
