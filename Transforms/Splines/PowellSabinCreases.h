#pragma once

#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Splines/PowellSabinTriangles.h"

namespace crease {

/// How feature lines become creases.
struct PowellSabinOptions {
  bool creases = true;  ///< false: lines stay mesh edges, the spline is C1 across them
};

/// Gives every vertex of a domain its functions: three by enclosing_triangle(); four where one feature line passes
/// or meets the border, so that the gradient may jump across its tangent.
///
/// Of the four control points two lie on the tangent and one on either side: a triangle per side, which
/// share a side. Where the line is straight the spline is C1 on both sides and C0 across it. Where it turns, C1 on
/// both sides and C0 would close the crease at the vertex; so the near side (the body's, else the left)
/// decides on the line's edges, and on the far side the small triangles along the line
/// bend against their neighbours, by the jump times the sine of half the turn. They are the crease's band: bending
/// skips them, and so does rigidity where no body lies on the near side.
///
/// Creases close at their ends inside the domain, where three or more lines meet, and where a line turns by
/// more than 120 degrees; CornerRule does not matter.
/// @throws InvalidInput for what PowellSabinSplit refuses, and lines that do not follow edges.
PowellSabinNet place_powell_sabin(const DomainMesh& domain, const PowellSabinOptions& options = {});

/// Four points in space round the given ones, which lie at (t, p, q) with q = 0 on the far side and p = 0 on the near
/// side of a crease along t: two on the line p = p_0, q = q_0 that is nearest to p = q = 0 with no point
/// on the wrong side, one beyond it on either side. Near the least size.
/// @throws InvalidInput when all points lie on one side.
Eigen::Matrix<double, 3, 4> enclosing_tetrahedron(const Eigen::Matrix3Xd& points);

}  // namespace crease
