#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "Core/Point.h"
#include "Transforms/Transform.h"

namespace crease {

enum class Invertibility {
  kCertified,      ///< det grad T > 0 everywhere in the domain
  kFolded,         ///< det grad T <= 0 at a point of it
  kUndecided,      ///< neither could be shown: det comes too near to 0
  kNotCertifiable  ///< no certificate is known for this kind of transform
};
/// "certified", "folded", "undecided", "not certifiable".
std::string to_string(Invertibility verdict);

/// Where det grad T > 0 does not hold or could not be shown.
template <int Dim>
struct FailingRegion {
  std::vector<Point<Dim>> corners;     ///< mm, of the part of a cell that was examined last
  double size_mm = 0;                  ///< its longest edge
  Point<Dim> at = Point<Dim>::Zero();  ///< its corner where det is least, mm
  double determinant = 0;  ///< there, within the cell: at a crease det has several values
  int patch = -1;          ///< triangle or knot span, -1: everywhere
  int part = 0;            ///< of a composite transform, whose input the points are then
};

/// What is known about det grad T over the whole domain of T, not at samples only.
template <int Dim>
struct InvertibilityCertificate {
  Invertibility verdict = Invertibility::kNotCertifiable;
  /// det grad T is not below it anywhere in the domain, rounding taken into account; NaN if not certifiable.
  double lower_bound = std::numeric_limits<double>::quiet_NaN();
  std::optional<FailingRegion<Dim>>
      failing;  ///< of a patch that is folded, else undecided: the lowest
  int num_patches = 0;
  int num_examined = 0;              ///< of them cell by cell
  int num_failing = 0;               ///< folded or undecided
  std::vector<double> patch_bounds;  ///< of a spline: lower bounds by patch
  double seconds = 0;

  bool certified() const { return verdict == Invertibility::kCertified; }
};

struct CertificateOptions {
  /// Where det comes near to 0, cells are divided until their parts are this small, in mean edges of the
  /// basis.
  double smallest_part = 1e-4;
  /// Look closer at the lowest patches until the lower bound is at least half of a value that det has;
  /// false: stop when the sign is clear.
  bool tighten = true;
};

/// Shows that det grad T > 0 everywhere in T's domain, or where it is not.
///
/// On a cell of a spline (the cells of the knot lines of a triangular B-spline, the knot spans of a tensor
/// product) det grad T is a polynomial. In Bernstein form its smallest coefficient bounds it from below, the
/// better the smaller the cell is: parts are halved until their bound is positive, a corner has det <= 0, or
/// they are too small. Most patches need none of this: a rough bound from their control points is positive.
/// Rounding is bounded beside: see DeterminantPieces.h; gradients of triangular B-splines count as right to
/// 1e-12 of the largest.
///
/// What a certificate means: T is locally one to one everywhere in its domain, and keeps orientation. It
/// is one to one as a whole if, besides, it is so on the domain's border. It says nothing about the
/// continuation outside the domain. At a crease every side has its own det; all are certified.
/// A composite transform is certified where all of its parts are within their domains (in_domain). Rigid
/// and affine maps have one determinant. Other transforms are not certifiable.
///
/// In parallel, the same on any number of threads.
template <int Dim>
InvertibilityCertificate<Dim> certify_invertibility(const Transform<Dim>& transform,
                                                    const CertificateOptions& options = {});

extern template InvertibilityCertificate<2> certify_invertibility<2>(const Transform<2>&,
                                                                     const CertificateOptions&);
extern template InvertibilityCertificate<3> certify_invertibility<3>(const Transform<3>&,
                                                                     const CertificateOptions&);

}  // namespace crease
