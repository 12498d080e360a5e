#include "Transforms/Splines/PowellSabinBasis.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/MeshEdges.h"
#include "Transforms/Splines/KnotBorder.h"
#include "Transforms/Splines/KnotCellRule.h"
#include "Transforms/Splines/KnotLocator.h"
#include "Transforms/Splines/PowellSabinGrid.h"
#include "Transforms/Splines/PowellSabinPieces.h"
#include "Transforms/Splines/PowellSabinSides.h"

namespace crease {
namespace {

constexpr double kOutside = 1e-9;  // barycentric coordinates of points below -kOutside are negative
constexpr double kStraight = 1e-7;  // sine of half a line's turn that is none

const PowellSabinNet& sized(const PowellSabinNet& net) {
  if (net.vertices.size() != net.mesh.vertices.size()) {
    throw InvalidInput(message("PowellSabinBasis: ", net.vertices.size(), " triangles for ",
                               net.mesh.vertices.size(), " vertices; each needs one."));
  }
  return net;
}

std::vector<Vector<2>> normals_of(const PowellSabinNet& net) {
  std::vector<Vector<2>> normals;
  for (const auto& vertex : sized(net).vertices) normals.push_back(vertex.normal);
  return normals;
}

// Functions of a vertex: rows value, d/dx, d/dy, d/d depth.
using LiftedJets = Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::ColMajor, 4, 4>;

LiftedJets lifted_jets(const PowellSabinNet& net, int v) {
  const PowellSabinVertex& vertex = net.vertices[v];
  const auto fail = [&](const char* what) {
    throw InvalidInput(message("PowellSabinBasis: the triangle of vertex ", v, what));
  };
  const int count = vertex.num_functions();
  if (count != (vertex.normal.isZero(0) ? 3 : 4)) {
    fail(" has the wrong number of corners; it needs 3, or 4 on a crease.");
  }
  Eigen::Matrix4d system = Eigen::Matrix4d::Identity();
  system.row(0).head(count).setOnes();
  system.block(1, 0, 3, count) = vertex.corners;
  system.block(1, 0, 2, count).colwise() -= net.mesh.vertices[v];
  if (count == 3) system(3, 3) = 1;
  const double size = system.bottomRows<3>().cwiseAbs().maxCoeff();
  const double content = system.determinant();
  const bool positive = count == 3 ? content > 0 : std::abs(content) > 1e-9 * std::pow(size, 3);
  if (!positive || !system.allFinite()) fail(" is folded, flat or not finite.");
  return system.inverse().topRows(count).transpose();
}

// As they are on one side of the crease.
PowellSabinJets one_sided(const LiftedJets& jets, const Vector<2>& normal, bool far) {
  PowellSabinJets result = jets.topRows<3>();
  if (far) result.bottomRows<2>() += normal * jets.row(3);
  return result;
}

void check_points(const LiftedJets& jets, const Eigen::Matrix3Xd& points, int v) {
  for (const auto& p : points.colwise()) {
    const Eigen::VectorXd values = jets.transpose() * Eigen::Vector4d(1, p[0], p[1], p[2]);
    if (!(values.minCoeff() > -kOutside)) {
      throw InvalidInput(
          message("PowellSabinBasis: the triangle of vertex ", v, " does not hold the point at (",
                  p.head<2>().transpose(),
                  ") mm from it, so that functions would be negative; make it larger."));
    }
  }
}

}  // namespace

PowellSabinBasis::PowellSabinBasis(PowellSabinNet net) : net_(std::move(net)), first_{0} {
  const PowellSabinSplit split(net_.mesh);
  const PowellSabinSides sides(net_.mesh, split, net_.crease_edges, normals_of(net_));
  std::vector<LiftedJets> jets;
  for (int v = 0; v < static_cast<int>(net_.vertices.size()); ++v) {
    jets.push_back(lifted_jets(net_, v));
    check_points(jets.back(), sides.points(net_.mesh, split, v), v);
    first_.push_back(first_.back() + net_.vertices[v].num_functions());
  }
  for (int t = 0; t < static_cast<int>(net_.mesh.simplices.size()); ++t) {
    const auto& s = net_.mesh.simplices[t];
    PowellSabinPatch::Parts parts;
    parts.corners = simplex_corners(net_.mesh, t);
    parts.centre = split.centre(t);
    parts.centre_weights = split.centre_weights(t);
    parts.bands = {};
    for (int k = 0; k < 3; ++k) {
      const int edge = split.edge_of(t, k), crease = sides.crease_of(edge);
      parts.edge_points[k] = split.edge_point(edge);
      parts.shares[k] = split.share(edge, s[k]);
      parts.jets[k] = one_sided(jets[s[k]], sides.normal(s[k]), sides.is_far(t, k));
      parts.first_control_point[k] = first_[s[k]];
      for (int end = 0; end < 2; ++end) {  // on creases the near side decides
        const int corner = (k + end) % 3, v = s[corner];
        const bool far = sides.is_far(t, corner);
        parts.edge_jets[k][end] = one_sided(jets[v], sides.normal(v), far && crease < 0);
        const Vector<2> along = (split.edge_point(edge) - net_.mesh.vertices[v]).normalized();
        if (crease >= 0 && far && std::abs(along.dot(sides.normal(v))) > kStraight) {
          parts.bands[2 * k + end] = net_.crease_edges[crease].body_side ? 1 : 2;
        }
      }
    }
    patches_.emplace_back(parts);
  }
  locator_ = std::make_unique<KnotLocator<2>>(net_.mesh, kKnotTie * mesh_scale(net_.mesh));
  border_ = NearestFacets<2>(net_.mesh, border_facets<2>(net_.mesh));
  const MeshFigures figures = mesh_figures(net_.mesh);
  measure_ = figures.area;
  mean_edge_length_ = figures.mean_edge;
}

PowellSabinBasis::~PowellSabinBasis() = default;

int PowellSabinBasis::find_simplex(const Point<2>& x) const { return locator_->find(x); }

Box<2> PowellSabinBasis::bounds() const { return locator_->bounds(); }

Point<2> PowellSabinBasis::nearest_point(const Point<2>& x) const {
  return contains(x) ? x : border_.find(x).point;
}

Eigen::VectorXd PowellSabinBasis::control_values(std::span<const double> values,
                                                 std::span<const Vector<2>> gradients) const {
  if (values.size() != net_.vertices.size() || gradients.size() != net_.vertices.size()) {
    throw InvalidInput(message("PowellSabinBasis: ", values.size(), " values and ",
                               gradients.size(), " gradients for ", net_.vertices.size(),
                               " vertices; give one of each."));
  }
  const ControlPoints<2> greville = greville_points();
  Eigen::VectorXd c(num_control_points());
  for (std::size_t v = 0; v < values.size(); ++v) {
    for (int i = first_[v]; i < first_[v + 1]; ++i) {
      c[i] = values[v] + gradients[v].dot(greville.col(i) - net_.mesh.vertices[v]);
    }
  }
  return c;
}

ControlPoints<2> PowellSabinBasis::greville_points() const {
  ControlPoints<2> points(2, num_control_points());
  for (std::size_t v = 0; v < net_.vertices.size(); ++v) {
    points.middleCols(first_[v], net_.vertices[v].num_functions()) =
        net_.vertices[v].corners.topRows<2>();
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

QuadratureElement<2> PowellSabinBasis::element(int triangle, int band, int polynomial_degree,
                                               int derivatives) const {
  const PowellSabinPatch& patch = patches_[triangle];
  std::vector<int> cells;
  for (int c = 0; c < PowellSabinPatch::kNumCells; ++c) {
    if (patch.band(c) == band) cells.push_back(c);
  }
  const auto per_cell = static_cast<Eigen::Index>(triangle_rule(polynomial_degree).weights.size());
  const Eigen::Index count = std::ssize(cells) * per_cell;
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(patch.num_functions(), count);
  QuadratureElement<2> result;
  result.control_points.assign(patch.control_points().begin(), patch.control_points().end());
  result.region = net_.mesh.region(triangle);
  result.patch = triangle;
  result.in_band = band > 0;
  result.in_two_sided_band = band == 2;
  result.points.resize(2, count);
  result.weights.resize(count);
  result.values = zero;
  if (derivatives > 0) result.gradients.assign(2, zero);
  if (derivatives > 1) result.hessians.assign(3, zero);
  CellRule rule;
  Eigen::Index q = 0;
  for (int c : cells) {
    set_cell_rule(patch.cell(c), polynomial_degree, rule);
    for (Eigen::Index i = 0; i < per_cell; ++i, ++q) {
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
  std::vector<std::pair<int, int>> chosen;  // triangle, band
  for (int t = 0; t < static_cast<int>(patches_.size()); ++t) {
    if (wanted && !wanted(net_.mesh.region(t), t)) continue;
    for (int band = 0; band < 3; ++band) {
      if (patches_[t].has_band(band)) chosen.emplace_back(t, band);
    }
  }
  std::vector<QuadratureElement<2>> elements(chosen.size());
  parallel_for(std::ssize(chosen), [&](std::int64_t i) {
    elements[i] = element(chosen[i].first, chosen[i].second, polynomial_degree, derivatives);
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
