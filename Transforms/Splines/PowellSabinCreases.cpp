#include "Transforms/Splines/PowellSabinCreases.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "Core/Error.h"
#include "Core/Parallel.h"
#include "Transforms/Domains/ConvexPolygon.h"
#include "Transforms/Domains/VertexClouds.h"
#include "Transforms/Splines/PowellSabinSides.h"

namespace crease {
namespace {

constexpr double kLargestTurn = 120 * std::numbers::pi / 180;

// A triangle on the axis of t with its apex at (t, height): columns of enclosing_tetrahedron.
struct Half {
  double left = 0, right = 0, apex = 0, height = 0;
};

// The smallest of some triangles on the axis that hold points (t, y), y >= 0: heights of the apex over the points'
// up to 3, its place from their left to their right end.
Half smallest_half(const std::vector<Vector<2>>& points) {
  double top = 0, low = 0, high = 0;
  for (const auto& p : points) {
    low = std::min(low, p[0]);
    high = std::max(high, p[0]);
    top = std::max(top, p[1]);
  }
  Half best;
  double least = std::numeric_limits<double>::infinity();
  constexpr int kHeights = 18, kPlaces = 20;
  for (int h = 0; h <= kHeights; ++h) {
    for (int k = 0; k <= kPlaces; ++k) {
      const double share = static_cast<double>(k) / kPlaces;
      Half half{1e300, -1e300, (1 - share) * low + share * high, (1.2 + 0.1 * h) * top};
      for (const auto& p : points) {  // carried to the axis along the line through the apex
        const double foot = half.apex + (p[0] - half.apex) * half.height / (half.height - p[1]);
        half.left = std::min(half.left, foot);
        half.right = std::max(half.right, foot);
      }
      const double area = half.height * (half.right - half.left);
      if (!(area < (1 - 1e-9) * least)) continue;
      least = area;
      best = half;
    }
  }
  return best;
}

// Whether no point has a negative barycentric coordinate.
bool holds(const Eigen::Matrix<double, 3, 4>& corners, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix4d system;
  system << Eigen::RowVector4d::Ones(), corners;
  Eigen::Matrix4Xd lifted(4, points.cols());
  lifted << Eigen::RowVectorXd::Ones(points.cols()), points;
  return (system.inverse() * lifted).minCoeff() > -1e-12;
}

// One line through a vertex: its directions there, and whether its near side is the left.
struct Passage {
  Vector<2> in, out;
  bool near_left = true;
};

class Creases {
 public:
  Creases(const DomainMesh& domain, const PowellSabinSplit& split)
      : mesh_(domain.mesh),
        topology_(split.topology()),
        lines_(line_edges(domain, topology_)),
        start_(lines_.size(), -1) {
    for (const auto& chain : domain.chains) {
      for (int e = 0; e < chain.num_edges(); ++e) {
        const int a = chain.vertices[e], b = chain.vertices[(e + 1) % chain.vertices.size()];
        int& start = start_[topology_.edge_between(a, b)];
        if (start < 0) start = a;
      }
    }
  }

  std::vector<CreaseEdge> edges() const {
    std::vector<CreaseEdge> result;
    for (std::size_t e = 0; e < lines_.size(); ++e) {
      if (is_crease(static_cast<int>(e))) {
        result.push_back({topology_.edges()[e].vertices, lines_[e].one_body()});
      }
    }
    return result;
  }

  /// From the near to the far side; 0 where no crease opens.
  Vector<2> normal_at(int vertex) const {
    std::vector<int> creases;
    for (int e : topology_.edges_at(vertex)) {
      if (is_crease(e)) creases.push_back(e);
    }
    const bool border = topology_.on_border(vertex);
    if (creases.size() != (border ? 1u : 2u)) return Vector<2>::Zero();
    if (border && topology_.border_edges_at(vertex).size() != 2) return Vector<2>::Zero();
    const Passage passage = passage_at(vertex, creases);
    if (std::abs(turn_angle(passage.in, passage.out)) > kLargestTurn) return Vector<2>::Zero();
    const Vector<2> left = turned_left((passage.in + passage.out).normalized());
    return passage.near_left ? Vector<2>(-left) : left;
  }

 private:
  bool is_crease(int edge) const {
    return lines_[edge].is_line && topology_.edges()[edge].triangles[1] >= 0;
  }
  // Along the first edge's own direction.
  Passage passage_at(int vertex, const std::vector<int>& creases) const {
    const int first = creases.front(), start = start_[first];
    const auto away = [&](int edge) {
      const int other = topology_.other_end(edge, vertex);
      return Vector<2>((mesh_.vertices[other] - mesh_.vertices[vertex]).normalized());
    };
    const bool leaves = start == vertex;
    const Vector<2> one = away(first),
                    two = creases.size() == 2 ? away(creases[1]) : Vector<2>(-one);
    const LineEdge& line = lines_[first];
    const bool ascends = start == topology_.edges()[first].vertices[0];
    const bool body_left = ascends ? line.body_left : line.body_right;
    return {leaves ? Vector<2>(-two) : Vector<2>(-one), leaves ? one : two,
            body_left || !line.one_body()};
  }

  const SimplexMesh<2>& mesh_;
  const MeshTopology& topology_;
  std::vector<LineEdge> lines_;
  std::vector<int> start_;  // of an edge: the vertex where its line enters it; -1: no line
};

PowellSabinVertex vertex_at(const PowellSabinSides& sides, const PowellSabinSplit& split,
                            const SimplexMesh<2>& mesh, int v) {
  const Eigen::Matrix3Xd points = sides.points(mesh, split, v);
  const Vector<2>& normal = sides.normal(v);
  if (normal.isZero(0)) {
    std::vector<Point<2>> flat;
    for (const auto& p : points.colwise()) flat.emplace_back(mesh.vertices[v] + p.head<2>());
    return triangle_vertex(enclosing_triangle(convex_hull(flat)));
  }
  // x, y, depth from t, p, q: x = t tangent + (p + q) normal, depth = p.
  Matrix<3> frame;
  frame << -normal.y(), normal.x(), normal.x(), normal.x(), normal.y(), normal.y(), 0, 1, 0;
  PowellSabinVertex vertex;
  vertex.normal = normal;
  vertex.corners = frame * enclosing_tetrahedron(frame.inverse() * points);
  vertex.corners.topRows<2>().colwise() += mesh.vertices[v];
  return vertex;
}

}  // namespace

Eigen::Matrix<double, 3, 4> enclosing_tetrahedron(const Eigen::Matrix3Xd& points) {
  const double p0 = std::min(0.0, points.row(1).minCoeff());
  const double q0 = std::max(0.0, points.row(2).maxCoeff());
  std::vector<Vector<2>> far, near;
  for (const auto& x : points.colwise()) {
    far.emplace_back(x[0], x[1] - p0);
    near.emplace_back(x[0], q0 - x[2]);
  }
  const Half far_half = smallest_half(far), near_half = smallest_half(near);
  if (!(far_half.height > 0) || !(near_half.height > 0)) {
    throw InvalidInput("enclosing_tetrahedron: all points lie on one side of the crease.");
  }
  Eigen::Matrix<double, 3, 4> corners;
  corners.col(0) << std::min(far_half.left, near_half.left), p0, q0;
  corners.col(1) << std::max(far_half.right, near_half.right), p0, q0;
  corners.col(2) << far_half.apex, p0 + far_half.height, q0;
  corners.col(3) << near_half.apex, p0, q0 - near_half.height;
  // Points that are off both planes, where the line turns, may lie beyond the slanted sides.
  const Vector<3> middle = 0.5 * (corners.col(0) + corners.col(1));
  for (int round = 0; round < 200 && !holds(corners, points); ++round) {
    corners = (1.05 * (corners.colwise() - middle)).colwise() + middle;
  }
  return corners;
}

PowellSabinNet place_powell_sabin(const DomainMesh& domain, const PowellSabinOptions& options) {
  const PowellSabinSplit split(domain.mesh);
  PowellSabinNet net;
  net.mesh = domain.mesh;
  std::vector<Vector<2>> normals(net.mesh.vertices.size(), Vector<2>::Zero());
  if (options.creases) {
    const Creases creases(domain, split);
    net.crease_edges = creases.edges();
    for (std::size_t v = 0; v < normals.size(); ++v) {
      normals[v] = creases.normal_at(static_cast<int>(v));
    }
  }
  const PowellSabinSides sides(net.mesh, split, net.crease_edges, std::move(normals));
  net.vertices.resize(net.mesh.vertices.size());
  parallel_for(std::ssize(net.vertices), [&](std::int64_t v) {
    net.vertices[static_cast<std::size_t>(v)] =
        vertex_at(sides, split, net.mesh, static_cast<int>(v));
  });
  return net;
}

}  // namespace crease
