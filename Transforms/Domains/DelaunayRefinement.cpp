#include "Transforms/Domains/DelaunayRefinement.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>

#include "Core/Error.h"

namespace crease {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
struct VertexNumber {
  int number = -1;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<VertexNumber, Kernel>;
using FaceBase = CGAL::Delaunay_mesh_face_base_2<Kernel>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure>;
using VertexHandle = Triangulation::Vertex_handle;
using FaceHandle = Triangulation::Face_handle;

Point<2> point_of(VertexHandle v) { return {v->point().x(), v->point().y()}; }

/// CGAL's size criterion with a bound that depends on the place.
class SizeFieldCriteria : public CGAL::Delaunay_mesh_criteria_2<Triangulation> {
 public:
  using Base = CGAL::Delaunay_mesh_criteria_2<Triangulation>;
  using Quality = CGAL::Delaunay_mesh_size_criteria_2<Triangulation>::Quality;

  SizeFieldCriteria(double shape_bound, const std::function<double(const Point<2>&)>& largest_edge)
      : Base(shape_bound), largest_edge_(&largest_edge) {}

  // NOLINTBEGIN(readability-identifier-naming): CGAL asks for these names
  class Is_bad {
   public:
    using Point_2 = Triangulation::Point;
    // NOLINTEND(readability-identifier-naming)
    Is_bad(double shape_bound, const std::function<double(const Point<2>&)>& largest_edge)
        : shape_bound_(shape_bound), largest_edge_(largest_edge) {}

    CGAL::Mesh_2::Face_badness operator()(const Quality& quality) const {
      if (quality.size() > 1) return CGAL::Mesh_2::IMPERATIVELY_BAD;
      return quality.sine() < shape_bound_ ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD;
    }

    CGAL::Mesh_2::Face_badness operator()(const FaceHandle& face, Quality& quality) const {
      const Point<2> a = point_of(face->vertex(0)), b = point_of(face->vertex(1)),
                     c = point_of(face->vertex(2));
      std::array<double, 3> squares = {(b - a).squaredNorm(), (c - b).squaredNorm(),
                                       (a - c).squaredNorm()};
      std::sort(squares.begin(), squares.end());
      const double largest = largest_edge_((a + b + c) / 3);
      const double twice_area = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
      quality.second = squares[2] / (largest * largest);
      quality.first = quality.size() > 1 ? 1 : twice_area * twice_area / (squares[2] * squares[1]);
      return operator()(quality);
    }

   private:
    double shape_bound_;
    const std::function<double(const Point<2>&)>& largest_edge_;
  };

  Is_bad is_bad_object() const { return {this->bound(), *largest_edge_}; }

 private:
  const std::function<double(const Point<2>&)>* largest_edge_;
};

std::vector<VertexHandle> insert_graph(const DelaunayInput& input, Triangulation& triangulation) {
  std::vector<VertexHandle> handles;
  FaceHandle hint;
  for (std::size_t i = 0; i < input.vertices.size(); ++i) {
    const Point<2>& p = input.vertices[i];
    const VertexHandle v = triangulation.insert({p.x(), p.y()}, hint);
    if (v->info().number < 0) v->info().number = static_cast<int>(i);
    handles.push_back(v);
    hint = v->face();
  }
  for (const auto& edge : input.edges) {
    const VertexHandle a = handles[edge[0]], b = handles[edge[1]];
    if (a == b) continue;
    try {
      triangulation.insert_constraint(a, b);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
      const Point<2>&p = input.vertices[edge[0]], &q = input.vertices[edge[1]];
      throw InvalidInput(message("mesh: the edge from (", p.x(), ", ", p.y(), ") to (", q.x(), ", ",
                                 q.y(), ") mm crosses another edge of a line or of the border."));
    }
  }
  hint = handles.back()->face();  // constraints have replaced faces
  for (const auto& p : input.inner_points) {
    hint = triangulation.insert({p.x(), p.y()}, hint)->face();
  }
  return handles;
}

/// The vertices on the constrained way from a to b.
std::vector<VertexHandle> path_between(const Triangulation& triangulation, VertexHandle a,
                                       VertexHandle b) {
  std::vector<VertexHandle> path{a};
  const Point<2> end = point_of(b);
  while (path.back() != b) {
    const VertexHandle v = path.back();
    const Vector<2> direction = (end - point_of(v)).normalized();
    VertexHandle best;
    double largest_cosine = 0.99;
    auto edge = triangulation.incident_edges(v), first = edge;
    do {
      if (triangulation.is_infinite(edge) || !edge->first->is_constrained(edge->second)) continue;
      VertexHandle w = edge->first->vertex(Triangulation::cw(edge->second));
      if (w == v) w = edge->first->vertex(Triangulation::ccw(edge->second));
      const double cosine = (point_of(w) - point_of(v)).normalized().dot(direction);
      if (cosine > largest_cosine) {
        largest_cosine = cosine;
        best = w;
      }
    } while (++edge != first);
    if (best == VertexHandle()) throw SolverError("mesh: an edge of a line was lost.");
    path.push_back(best);
  }
  return path;
}

DelaunayOutput extract(const DelaunayInput& input, const Triangulation& triangulation,
                       const std::vector<VertexHandle>& handles) {
  DelaunayOutput output;
  std::vector<VertexHandle> order;
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end();
       ++v) {
    order.push_back(v);
  }
  // Input vertices first; the others come in the order in which they were made.
  std::stable_sort(order.begin(), order.end(), [](VertexHandle v, VertexHandle w) {
    return static_cast<unsigned>(v->info().number) < static_cast<unsigned>(w->info().number);
  });
  std::vector<char> used(order.size(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) order[i]->info().number = static_cast<int>(i);
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f) {
    if (!f->is_in_domain()) continue;
    for (int k = 0; k < 3; ++k) used[f->vertex(k)->info().number] = 1;
  }
  std::vector<int> number(order.size(), -1);
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!used[i]) continue;
    number[i] = static_cast<int>(output.mesh.vertices.size());
    output.mesh.vertices.push_back(point_of(order[i]));
  }
  for (auto f = triangulation.finite_faces_begin(); f != triangulation.finite_faces_end(); ++f) {
    if (!f->is_in_domain()) continue;
    std::array<int, 3> triangle{};
    for (int k = 0; k < 3; ++k) triangle[k] = number[f->vertex(k)->info().number];
    output.mesh.simplices.push_back(triangle);
  }
  for (const auto& edge : input.edges) {
    auto& path = output.edge_paths.emplace_back();
    for (const auto v : path_between(triangulation, handles[edge[0]], handles[edge[1]])) {
      path.push_back(number[v->info().number]);
    }
  }
  return output;
}

}  // namespace

DelaunayOutput refine_delaunay(const DelaunayInput& input) {
  Triangulation triangulation;
  const auto handles = insert_graph(input, triangulation);
  const SizeFieldCriteria criteria(input.shape_bound, input.largest_edge);
  CGAL::Delaunay_mesher_2<Triangulation, SizeFieldCriteria> mesher(triangulation, criteria);
  std::vector<Kernel::Point_2> seeds;
  for (const auto& p : input.holes) seeds.emplace_back(p.x(), p.y());
  mesher.set_seeds(seeds.begin(), seeds.end(), false);
  mesher.init();
  while (!mesher.is_refinement_done()) {
    mesher.step_by_step_refine_mesh();
    if (static_cast<int>(triangulation.number_of_vertices()) > input.most_vertices) {
      return {{}, {}, true};
    }
  }
  return extract(input, triangulation, handles);
}

}  // namespace crease
