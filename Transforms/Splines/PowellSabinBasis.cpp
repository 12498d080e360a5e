#include "Transforms/Splines/PowellSabinBasis.h"

#include <algorithm>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/MeshEdges.h"
#include "Transforms/Splines/KnotBorder.h"
#include "Transforms/Splines/KnotCellRule.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/PowellSabinGrid.h"
#include "Transforms/Splines/PowellSabinPieces.h"
#include "Transforms/Splines/SimplexSpline.h"

namespace crease {
namespace {

constexpr double kOutside = 1e-9;  // barycentric coordinates of points below -kOutside are negative

// Barycentric coordinates in a vertex' triangle, at the vertex.
PowellSabinJets jets_at(const Point<2>& v, const PowellSabinTriangle& q) {
  const double content = signed_content<2>(q);
  PowellSabinJets jets(3, 3);
  for (int j = 0; j < 3; ++j) {
    jets(0, j) = signed_content<2>({v, q[(j + 1) % 3], q[(j + 2) % 3]}) / content;
  }
  jets.bottomRows<2>() = barycentric_gradients<2>(q);
  return jets;
}

std::vector<PowellSabinJets> checked_jets(const PowellSabinNet& net,
                                          const PowellSabinSplit& split) {
  if (net.triangles.size() != net.mesh.vertices.size()) {
    throw InvalidInput(message("PowellSabinBasis: ", net.triangles.size(), " triangles for ",
                               net.mesh.vertices.size(), " vertices; each needs one."));
  }
  std::vector<PowellSabinJets> all;
  for (int v = 0; v < static_cast<int>(net.triangles.size()); ++v) {
    const PowellSabinTriangle& q = net.triangles[v];
    if (!(signed_content<2>(q) > 0)) {
      throw InvalidInput(message("PowellSabinBasis: the triangle of vertex ", v,
                                 " is folded, flat or not finite."));
    }
    all.push_back(jets_at(net.mesh.vertices[v], q));
    for (const auto& p : powell_sabin_points(net.mesh, split, v)) {
      const Vector<2> d = p - net.mesh.vertices[v];
      const Vector<3> coordinates = all.back().transpose() * Vector<3>(1, d.x(), d.y());
      if (!(coordinates.minCoeff() > -kOutside)) {
        throw InvalidInput(message("PowellSabinBasis: the triangle of vertex ", v,
                                   " does not hold the point (", p.transpose(),
                                   ") mm, so that functions would be negative; make it larger."));
      }
    }
  }
  return all;
}

}  // namespace

PowellSabinBasis::PowellSabinBasis(PowellSabinNet net) : net_(std::move(net)) {
  const PowellSabinSplit split(net_.mesh);
  const auto jets = checked_jets(net_, split);
  for (int t = 0; t < static_cast<int>(net_.mesh.simplices.size()); ++t) {
    const auto& s = net_.mesh.simplices[t];
    PowellSabinPatch::Parts parts;
    parts.corners = simplex_corners(net_.mesh, t);
    parts.centre = split.centre(t);
    parts.centre_weights = split.centre_weights(t);
    for (int k = 0; k < 3; ++k) {
      const int edge = split.edge_of(t, k);
      parts.edge_points[k] = split.edge_point(edge);
      parts.shares[k] = split.share(edge, s[k]);
      parts.jets[k] = jets[s[k]];
      parts.edge_jets[k] = {jets[s[k]], jets[s[(k + 1) % 3]]};
      parts.first_control_point[k] = 3 * s[k];
    }
    patches_.emplace_back(parts);
  }
  locator_ = std::make_unique<KnotLocator<2>>(net_.mesh, kKnotTie * mesh_scale(net_.mesh));
  border_ = border_facets<2>(net_.mesh);
  const MeshFigures figures = mesh_figures(net_.mesh);
  measure_ = figures.area;
  mean_edge_length_ = figures.mean_edge;
}

PowellSabinBasis::~PowellSabinBasis() = default;

int PowellSabinBasis::find_simplex(const Point<2>& x) const { return locator_->find(x); }

Box<2> PowellSabinBasis::bounds() const { return locator_->bounds(); }

Point<2> PowellSabinBasis::nearest_point(const Point<2>& x) const {
  return contains(x) ? x : nearest_on_facets<2>(net_.mesh, border_, x);
}

Eigen::VectorXd PowellSabinBasis::control_values(std::span<const double> values,
                                                 std::span<const Vector<2>> gradients) const {
  if (values.size() != net_.triangles.size() || gradients.size() != net_.triangles.size()) {
    throw InvalidInput(message("PowellSabinBasis: ", values.size(), " values and ",
                               gradients.size(), " gradients for ", net_.triangles.size(),
                               " vertices; give one of each."));
  }
  Eigen::VectorXd c(num_control_points());
  for (std::size_t v = 0; v < values.size(); ++v) {
    for (std::size_t j = 0; j < 3; ++j) {
      c[static_cast<Eigen::Index>(3 * v + j)] =
          values[v] + gradients[v].dot(net_.triangles[v][j] - net_.mesh.vertices[v]);
    }
  }
  return c;
}

ControlPoints<2> PowellSabinBasis::greville_points() const {
  ControlPoints<2> points(2, num_control_points());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    points.col(i) =
        net_.triangles[static_cast<std::size_t>(i / 3)][static_cast<std::size_t>(i % 3)];
  }
  return points;
}

BasisValues<2> PowellSabinBasis::evaluate(const Point<2>& x, int derivatives) const {
  const int triangle = find_simplex(x);
  if (triangle < 0) {
    throw InvalidInput(message("PowellSabinBasis: the point (", x.transpose(),
                               ") mm lies outside the domain; use nearest_point() first."));
  }
  const PowellSabinPatch& patch = patches_[triangle];
  const auto found = patch.evaluate(patch.find_cell(x), x, derivatives);
  BasisValues<2> result;
  result.control_points.assign(patch.control_points().begin(), patch.control_points().end());
  result.values = found.col(0);
  if (derivatives > 0) result.gradients = found.middleCols<2>(1).transpose();
  if (derivatives > 1) result.hessians = found.rightCols<3>().transpose();
  return result;
}

QuadratureElement<2> PowellSabinBasis::element(int triangle, int polynomial_degree,
                                               int derivatives) const {
  const PowellSabinPatch& patch = patches_[triangle];
  const auto per_cell = static_cast<Eigen::Index>(triangle_rule(polynomial_degree).weights.size());
  const Eigen::Index count = PowellSabinPatch::kNumCells * per_cell;
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(patch.num_functions(), count);
  QuadratureElement<2> result;
  result.control_points.assign(patch.control_points().begin(), patch.control_points().end());
  result.region = net_.mesh.region(triangle);
  result.patch = triangle;
  result.points.resize(2, count);
  result.weights.resize(count);
  result.values = zero;
  if (derivatives > 0) result.gradients.assign(2, zero);
  if (derivatives > 1) result.hessians.assign(3, zero);
  CellRule rule;
  for (int c = 0; c < PowellSabinPatch::kNumCells; ++c) {
    set_cell_rule(patch.cell(c), polynomial_degree, rule);
    for (Eigen::Index i = 0; i < per_cell; ++i) {
      const Eigen::Index q = c * per_cell + i;
      const auto here = patch.evaluate(c, rule.points[i], derivatives);
      result.points.col(q) = rule.points[i];
      result.weights[q] = rule.weights[i];
      result.values.col(q) = here.col(0);
      for (int a = 0; a < 2 && derivatives > 0; ++a) result.gradients[a].col(q) = here.col(1 + a);
      for (int a = 0; a < 3 && derivatives > 1; ++a) result.hessians[a].col(q) = here.col(3 + a);
    }
  }
  return result;
}

std::vector<QuadratureElement<2>> PowellSabinBasis::quadrature(
    int polynomial_degree, int derivatives,
    const std::function<bool(int region, int patch)>& wanted) const {
  std::vector<int> chosen;
  for (int t = 0; t < static_cast<int>(patches_.size()); ++t) {
    if (!wanted || wanted(net_.mesh.region(t), t)) chosen.push_back(t);
  }
  std::vector<QuadratureElement<2>> elements(chosen.size());
  parallel_for(std::ssize(chosen), [&](std::int64_t i) {
    elements[i] = element(chosen[i], polynomial_degree, derivatives);
  });
  return elements;
}

std::vector<std::pair<int, int>> PowellSabinBasis::couplings() const {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& patch : patches_) {
    const auto points = patch.control_points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (std::size_t k = i; k < points.size(); ++k) pairs.emplace_back(points[i], points[k]);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

std::unique_ptr<BoundGrid<2>> PowellSabinBasis::bind(const Raster<2>& raster) const {
  return std::make_unique<PowellSabinGrid>(*this, raster);
}

double PowellSabinBasis::edge_length(const Point<2>& x) const {
  const int simplex = find_simplex(x);
  return simplex < 0 ? mean_edge_length_ : crease::mean_edge_length(net_.mesh, simplex);
}

std::unique_ptr<DeterminantPieces<2>> PowellSabinBasis::determinant_pieces(
    const ControlPoints<2>& phi, const Matrix<2>& linear) const {
  return std::make_unique<PowellSabinPieces>(patches_, phi, linear);
}

}  // namespace crease
