#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "Images/Image.h"
#include "Registration/Landmarks.h"
#include "Registration/Registration.h"
#include "Transforms/Domains/DomainMesh.h"
#include "Transforms/Domains/KnotPlacement.h"
#include "Transforms/Domains/Mesher.h"
#include "Transforms/Domains/RegionOfInterest.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {

/// Splines on triangles, with creases along lines.
enum class TriangleSpline {
  kTriangular,  ///< triangular B-splines
  /// Powell-Sabin splines: C1 quadratics that bend as they should with a third of the control points of
  /// cubics on the same triangles.
  kPowellSabin
};

/// How fine a creased domain is and how smooth its splines are. Lengths in mm, 0 asks for the default.
struct CreasedDomainOptions {
  /// With kPowellSabin degree, smoothness and rigid_bodies do not matter.
  TriangleSpline spline = TriangleSpline::kTriangular;
  int degree = 3;
  int smoothness = -1;  ///< continuous derivatives away from creases; -1: degree - 1
  bool creases = true;  ///< false: lines stay edges of the mesh, the spline is smooth across them
  /// All knots at their vertices (KnotOptions::collapse_all): Lagrange's finite elements, for comparisons.
  bool collapse_knots = false;
  double edge_length = 0;  ///< away from lines; default a twelfth of the region's longer side
  /// Default half of edge_length: on phantoms of rigid bodies a quarter costs 40 to 90 % more triangles
  /// and changes no error by more than a tenth.
  double edge_length_near_lines = 0;
  double gradation = 0.8;  ///< growth of the edge length per mm of distance to a line
  /// mm that edges may run off curved lines; default a pixel of the label image, else 1/20 of the edges
  /// near lines. For creases a pixel will do: half of it costs a third more triangles.
  double line_tolerance = 0;
  int num_triangles = 0;                  ///< > 0: about as many, whatever the edge lengths
  std::vector<FineDisc> fine_discs = {};  ///< finer than the other lengths ask for
  /// Whether a rigidity energy will hold bodies rigid: their inner vertices then need no knots apart
  /// from themselves, which makes that energy cheap.
  bool rigid_bodies = true;
  /// Landmarks to be met exactly: where they contradict each other, or nearly, triangles are divided up to
  /// four times (LandmarkRefinement). Those with a sigma do not count.
  Landmarks<2> landmarks = {};
};

/// A triangulated region, its feature lines and the splines on it.
struct CreasedDomain {
  std::shared_ptr<const SplineBasis<2>> basis;
  DomainMesh mesh;   ///< as triangulated; its regions are body labels
  FeaturePlan plan;  ///< what became of the knots of each vertex; empty for Powell-Sabin splines
  std::vector<FeatureLine> feature_lines;
  std::vector<std::string> notes;     ///< what was merged, clipped, split
  std::vector<std::string> warnings;  ///< what the user should look at

  bool has_bodies() const;
  /// @throws InvalidInput when the splines are others.
  const TriangularBSplineBasis<2>& triangular_basis() const;
};

/// Meshes a region so that the lines run along edges, and puts knots on its vertices so that the spline
/// may bend sharply along the lines.
/// @throws InvalidInput for lines that cannot be meshed, options out of range, and landmarks that cannot be
/// met together.
CreasedDomain make_creased_domain(const RegionOfInterest& region,
                                  const std::vector<FeatureLine>& lines,
                                  const CreasedDomainOptions& options = {});

/// The same with the outlines of rigid bodies as lines: label 0 is soft, k > 0 rigid body k.
/// @param lines  further lines.
/// @throws InvalidInput also when no label is above 0.
CreasedDomain make_creased_domain(const RegionOfInterest& region, const LabelImage<2>& labels,
                                  const std::vector<FeatureLine>& lines,
                                  const CreasedDomainOptions& options = {});

/// The number of the body that holds each sample, 0 for soft tissue and outside the region.
LabelImage<2> body_labels(const CreasedDomain& domain, const Raster<2>& raster);

/// The edge length that an option of 0 stands for: a twelfth of the longest side of the box.
template <int Dim>
double default_edge_length(const Box<Dim>& box) {
  return box.size().maxCoeff() / 12;
}

/// gamma = 1e-3 h^2 (mm^2), h the mean edge length: the weight of bending that leaves results
/// independent of units and resolution. Source: experiment 2 of the dissertation, chapter 3.
template <int Dim>
double default_bending_weight(const SplineBasis<Dim>& basis) {
  return 1e-3 * basis.mean_edge_length() * basis.mean_edge_length();
}

/// The label of the nearest pixel, 0 beyond the image: the region of a point for bases that know none
/// themselves. The labels are copied.
template <int Dim>
std::function<int(const Point<Dim>&)> region_of_label(const LabelImage<Dim>& labels);

/// 1 in the bodies of a label image (nearest pixel), 0 elsewhere and beyond it: for bases that know no
/// bodies themselves. The labels are copied.
template <int Dim>
WeightField<Dim> label_weights(const LabelImage<Dim>& labels);

extern template std::function<int(const Point<2>&)> region_of_label<2>(const LabelImage<2>&);
extern template std::function<int(const Point<3>&)> region_of_label<3>(const LabelImage<3>&);
extern template WeightField<2> label_weights<2>(const LabelImage<2>&);
extern template WeightField<3> label_weights<3>(const LabelImage<3>&);

}  // namespace crease
