#pragma once

#include <span>
#include <vector>

#include "Transforms/Domains/KnotNet.h"
#include "Transforms/Splines/SimplexSpline.h"

namespace crease::testing {

/// cells_x x cells_y squares of 10 mm, each cut into two triangles, counter-clockwise.
SimplexMesh<2> grid_mesh(int cells_x, int cells_y);
/// The same with inner vertices moved at random by up to 2 mm.
SimplexMesh<2> jittered_mesh(int cells_x, int cells_y, int seed);

/// Generic clouds at inner vertices (radius alpha times the smallest inradius), in the outer wedge at
/// border vertices; 1.7 i rotates the pattern of vertex i unless `same_pattern`.
KnotNet<2> spread_knots(SimplexMesh<2> mesh, int degree, double alpha, bool same_pattern = false);
KnotNet<2> jittered_net(int cells_x, int cells_y, int degree, double alpha, int seed);
/// The net shrunk so that no coordinate exceeds 8: absolute tolerances refer to such nets.
KnotNet<2> within_eight(KnotNet<2> net);
/// All knots at the vertices: Bernstein polynomials.
KnotNet<2> collapsed_knots(SimplexMesh<2> mesh, int degree);

/// A straight crease from the bottom to the top of a grid of 4 x 4 cells along x = 20, knots of its
/// vertices on its line (outside the domain at its ends).
KnotNet<2> straight_crease_net(int degree, double alpha);
/// A 12-gon of radius 1 around 0 in a square of half-width 2.2, fanned knots along the 12-gon, body
/// inside or no body.
KnotNet<2> ring_net(int degree, double alpha, bool body);

/// Jittered nets and straight creases of degree 1 to 5, and one with its knots at the vertices.
std::vector<KnotNet<2>> nets_of_all_degrees();

/// Twelve tetrahedra round an inner vertex, with border knots outside the cube.
KnotNet<3> tetrahedral_net(int degree, double alpha);

/// `per_simplex` random points in each simplex.
template <int Dim>
std::vector<Point<Dim>> points_inside(const SimplexMesh<Dim>& mesh, int per_simplex, int seed);
/// Corners, points on edges, all knots that lie in the domain, centroids.
std::vector<Point<2>> special_points(const KnotNet<2>& net);

/// N_beta^I by the plain recurrence; t_degree = t_0.
template <int Dim>
SplineJet<Dim> local_function(const KnotNet<Dim>& net, int simplex, int index, const Point<Dim>& u,
                              std::span<const Vector<Dim>> flag);

}  // namespace crease::testing
