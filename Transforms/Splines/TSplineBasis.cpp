#include "Transforms/Splines/TSplineBasis.h"

#include <algorithm>

#include "Core/Parallel.h"
#include "Transforms/GaussRule.h"
#include "Transforms/SparseRowGrid.h"
#include "Transforms/Splines/TensorBSplineFunctions.h"

namespace crease {
namespace {

TMesh checked(TMesh mesh) {
  mesh.check();
  const auto crossings = mesh.crossings();
  if (!crossings.empty()) {
    const auto& [across, up] = crossings.front();
    const auto place = [&](const TJunction& t) {
      return message("(", mesh.knot(0, t.at[0]), ", ", mesh.knot(1, t.at[1]), ")");
    };
    throw InvalidInput(message(
        "TSplineBasis: the extensions of the T-junctions at ", place(across), " and ", place(up),
        " meet, so that the mesh is not "
        "analysis-suitable; analysis_suitable(mesh) adds the edges it takes."));
  }
  return mesh;
}

/// Degree less the largest number of equal inner lines.
int smoothness_of(const TMesh& mesh) {
  int most = 1;
  for (int a : {0, 1}) {
    const auto& lines = mesh.lines(a);
    const int h = mesh.border_lines();
    for (int k = h, run = 0; k < std::ssize(lines) - h; ++k) {
      run = lines[k] == lines[k - 1] ? run + 1 : 1;
      most = std::max(most, run);
      if (run > mesh.degree()) {
        throw InvalidInput(message("TSplineBasis: line ", k, " of axis ", a, " repeats ", lines[k],
                                   " more than ", mesh.degree(), " times: the map would tear."));
      }
    }
  }
  return mesh.degree() - most;
}

ParameterBox<2> box_of(const TMesh& mesh, const Point<2>& origin, const Matrix<2>& direction) {
  ParameterBox<2> box{origin, direction};
  for (int a : {0, 1}) {
    box.lower[a] = mesh.lines(a).front();
    box.upper[a] = mesh.lines(a).back();
  }
  box.check("TSplineBasis");
  return box;
}

/// The cell between lines that holds a knot, never one of no width: at a line the one after it.
int find_cell(const std::vector<double>& lines, double u) {
  const auto above = std::upper_bound(lines.begin(), lines.end(), u);
  if (above != lines.end()) return static_cast<int>(above - lines.begin()) - 1;
  return static_cast<int>(std::lower_bound(lines.begin(), lines.end(), lines.back()) -
                          lines.begin()) -
         1;
}

}  // namespace

TSplineBasis::TSplineBasis(TMesh mesh, const Point<2>& origin, const Matrix<2>& direction)
    : mesh_(checked(std::move(mesh))),
      box_(box_of(mesh_, origin, direction)),
      smoothness_(smoothness_of(mesh_)),
      second_to_space_(second_derivatives_transform<2>(direction)) {
  const auto vertices = mesh_.vertices();
  greville_.resize(2, std::ssize(vertices));
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (int a : {0, 1}) {
      const auto lines = mesh_.knot_lines(a, vertices[i]);
      double sum = 0;
      for (int k = 1; k <= degree(); ++k) sum += mesh_.knot(a, lines[k]);
      greville_(a, i) = sum / degree();
    }
  }
  make_elements(vertices);
}

void TSplineBasis::make_elements(const std::vector<TPoint>& vertices) {
  const int cells_u = mesh_.num_lines(0) - 1, cells_v = mesh_.num_lines(1) - 1;
  element_of_cell_.assign(static_cast<std::size_t>(cells_u) * cells_v, -1);
  for (const TFace& face : mesh_.bezier_faces()) {
    Element element{face, {}, {}, {}, {}};
    for (int a : {0, 1}) {
      element.lower[a] = mesh_.knot(a, face.lower[a]);
      element.upper[a] = mesh_.knot(a, face.upper[a]);
    }
    if (!((element.upper - element.lower).minCoeff() > 0)) continue;
    for (int j = face.lower[1]; j < face.upper[1]; ++j) {
      for (int i = face.lower[0]; i < face.upper[0]; ++i) {
        element_of_cell_[j * cells_u + i] = static_cast<int>(elements_.size());
      }
    }
    elements_.push_back(std::move(element));
  }
  std::vector<int> last(elements_.size(), -1);  // function added to the element
  for (std::size_t n = 0; n < vertices.size(); ++n) {
    const std::array<std::vector<int>, 2> lines = {mesh_.knot_lines(0, vertices[n]),
                                                   mesh_.knot_lines(1, vertices[n])};
    std::array<std::vector<double>, 2> knots;
    for (int a : {0, 1}) {
      for (int line : lines[a]) knots[a].push_back(mesh_.knot(a, line));
    }
    for (int j = std::max(lines[1].front(), 0); j < std::min(lines[1].back(), cells_v); ++j) {
      for (int i = std::max(lines[0].front(), 0); i < std::min(lines[0].back(), cells_u); ++i) {
        const int e = element_of_cell_[j * cells_u + i];
        if (e < 0 || last[e] == static_cast<int>(n)) continue;
        last[e] = static_cast<int>(n);
        Element& element = elements_[e];
        element.functions.push_back(static_cast<int>(n));
        auto& ordinates = element.ordinates.emplace_back();
        for (int a : {0, 1}) {
          ordinates[a] = bezier_ordinates(knots[a], element.lower[a], element.upper[a]);
        }
      }
    }
  }
}

std::shared_ptr<const TSplineBasis> TSplineBasis::on(TMesh mesh) const {
  return std::make_shared<TSplineBasis>(std::move(mesh), box_.origin, box_.direction);
}

int TSplineBasis::find_element(const Vector<2>& u) const {
  const int i = find_cell(mesh_.lines(0), u[0]), j = find_cell(mesh_.lines(1), u[1]);
  return element_of_cell_[static_cast<std::size_t>(j) * (mesh_.num_lines(0) - 1) + i];
}

double TSplineBasis::mean_edge_length() const {
  double sum = 0;
  for (const Element& e : elements_) sum += (e.upper - e.lower).mean();
  return sum / static_cast<double>(elements_.size());
}

double TSplineBasis::edge_length(const Point<2>& x) const {
  const Element& e = elements_[find_element(box_.clamped(box_.coordinates(x)))];
  return (e.upper - e.lower).mean();
}

void TSplineBasis::multiply(const Element& element, const std::array<BSplineSegment, 2>& bernstein,
                            int derivatives, BasisValues<2>& result) const {
  const Eigen::Index count = std::ssize(element.functions);
  const Vector<2> size = element.upper - element.lower;
  result.values.resize(count);
  if (derivatives > 0) result.gradients.resize(2, count);
  if (derivatives > 1) result.hessians.resize(3, count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const BezierJet u = bezier_jet(element.ordinates[n][0], bernstein[0], size[0]);
    const BezierJet v = bezier_jet(element.ordinates[n][1], bernstein[1], size[1]);
    result.values[n] = u.value * v.value;
    if (derivatives > 0) {
      result.gradients.col(n) = box_.direction * Vector<2>(u.first * v.value, u.value * v.first);
    }
    if (derivatives > 1) {
      result.hessians.col(n) =
          second_to_space_ *
          Matrix<3, 1>(u.second * v.value, u.first * v.first, u.value * v.second);
    }
  }
}

BasisValues<2> TSplineBasis::evaluate(const Point<2>& x, int derivatives) const {
  const Vector<2> u = box_.inner_coordinates(x, "TSplineBasis");
  const Element& element = elements_[find_element(u)];
  std::array<BSplineSegment, 2> bernstein;
  for (int a : {0, 1}) {
    const double s = (u[a] - element.lower[a]) / (element.upper[a] - element.lower[a]);
    bernstein[a] = bernstein_segment(degree(), std::clamp(s, 0.0, 1.0), derivatives);
  }
  BasisValues<2> result;
  result.control_points = element.functions;
  multiply(element, bernstein, derivatives, result);
  return result;
}

ControlPoints<2> TSplineBasis::greville_points() const {
  return (box_.direction * greville_).colwise() + box_.origin;
}

std::vector<QuadratureElement<2>> TSplineBasis::quadrature(
    int polynomial_degree, int derivatives,
    const std::function<bool(int region, int patch)>& wanted) const {
  std::vector<int> patches;
  for (int e = 0; e < std::ssize(elements_); ++e) {
    if (!wanted || wanted(-1, e)) patches.push_back(e);
  }
  const GaussRule rule = gauss_rule(polynomial_degree / 2 + 1);
  const Eigen::Index q = std::ssize(rule.points);
  std::vector<BSplineSegment> bernstein;
  for (double s : rule.points) bernstein.push_back(bernstein_segment(degree(), s, derivatives));

  std::vector<QuadratureElement<2>> result(patches.size());
  parallel_for(std::ssize(patches), [&](std::int64_t n) {
    const Element& element = elements_[patches[n]];
    QuadratureElement<2>& out = result[n];
    const Eigen::Index k = std::ssize(element.functions);
    const Vector<2> size = element.upper - element.lower;
    out.patch = patches[n];
    out.control_points = element.functions;
    out.points.resize(2, q * q);
    out.weights.resize(q * q);
    out.values.resize(k, q * q);
    if (derivatives > 0) out.gradients.assign(2, Eigen::MatrixXd(k, q * q));
    if (derivatives > 1) out.hessians.assign(3, Eigen::MatrixXd(k, q * q));
    BasisValues<2> here;
    for (Eigen::Index j = 0, p = 0; j < q; ++j) {
      for (Eigen::Index i = 0; i < q; ++i, ++p) {
        const Vector<2> share(rule.points[i], rule.points[j]);
        out.points.col(p) = box_.point(element.lower + share.cwiseProduct(size));
        out.weights[p] = rule.weights[i] * rule.weights[j] * size.prod();
        multiply(element, {bernstein[i], bernstein[j]}, derivatives, here);
        out.values.col(p) = here.values;
        for (std::size_t a = 0; a < out.gradients.size(); ++a) {
          out.gradients[a].col(p) = here.gradients.row(a);
        }
        for (std::size_t s = 0; s < out.hessians.size(); ++s) {
          out.hessians[s].col(p) = here.hessians.row(s);
        }
      }
    }
  });
  return result;
}

std::vector<std::pair<int, int>> TSplineBasis::couplings() const {
  std::vector<std::pair<int, int>> pairs;
  for (const Element& element : elements_) {
    for (std::size_t k = 0; k < element.functions.size(); ++k) {
      for (std::size_t i = 0; i <= k; ++i) {
        pairs.emplace_back(element.functions[i], element.functions[k]);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

std::unique_ptr<BoundGrid<2>> TSplineBasis::bind(const Raster<2>& raster) const {
  return std::make_unique<SparseRowGrid<2>>(*this, raster);
}

}  // namespace crease
