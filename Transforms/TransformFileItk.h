#pragma once

#include <filesystem>

#include "Transforms/Transform.h"

namespace crease {

/// Whether ITK has the same transform, so that save_itk_transform() can write it: rigid, similarity and affine
/// maps, displacement fields, tensor-product B-splines of degree 1 to 3 whose affine part can be inverted, and
/// chains of these.
template <int Dim>
bool has_itk_equivalent(const Transform<Dim>& transform);

/// Writes a transform for ITK and what reads its files (3D Slicer, ANTs, SimpleITK): a text file, .tfm.
///
///     RigidTransform      Euler2DTransform, Euler3DTransform (exact near half turns too, where a
///                         versor loses half its digits)
///     SimilarityTransform Similarity2DTransform; in 3D an AffineTransform, for the same reason
///     AffineTransform     AffineTransform
///     SplineTransform     BSplineTransform of u when A is the identity; else a CompositeTransform,
///                         T(x) = A(x) + u(x) = A(x + v(x)) with v = A_lin^-1 u: first the
///                         BSplineTransform of v, then the AffineTransform A
///     DisplacementFieldTransform  DisplacementFieldTransform
///     CompositeTransform  CompositeTransform of all parts; the file lists the last one first, as ITK
///
/// Within the spline's domain ITK's map differs from ours by rounding alone. Outside it does not continue
/// the spline: its BSplineTransform leaves points there as they are, so that T(x) = A(x), with a jump at
/// the border. Which side of the border a point on it belongs to is decided by ITK's rounding.
///
/// Programs read any of these files without further ado but those of degree 1 and 2: ITK's factory knows
/// cubic B-splines only, and TransformFactory<BSplineTransform<double, Dim, 2>>::RegisterTransform()
/// makes the others known.
///
/// @throws InvalidInput when ITK has no such transform. @throws FileError when it cannot be written.
template <int Dim>
void save_itk_transform(const Transform<Dim>& transform, const std::filesystem::path& file);

}  // namespace crease
