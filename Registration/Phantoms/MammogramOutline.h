#pragma once

#include "Transforms/Domains/Polygon.h"

// The breast of the mammogram phantom by formulas: skin line, nipple, thickness and pectoral muscle.
//
// Lengths are in units of the frame's width W = H. The chest wall is x = 0, the breast points along +x
// and y runs down. An angle theta is measured about (0, 0.52) from +x towards +y.
namespace crease {

/// Width and height of the phantom's frame, mm: 1024 pixels of 0.2 mm.
constexpr double kMammogramWidthMm = 204.8;
/// Where the nipple is on the skin line.
constexpr double kNippleAngle = -0.05;

/// Distance of the skin line from (0, 0.52):
///
///     r(theta) = ((|cos theta| / 0.55)^2.2 + (|sin theta| / 0.40)^2.2)^(-1/2.2)
///                (1 + 0.015 sin(3 theta + 1) + 0.01 sin 5 theta)
///                + 0.022 exp(-((theta + 0.05) / 0.045)^2),
///
/// a superellipse with two ripples and a nipple. Beyond |theta| = pi/2, behind the chest wall, it goes on,
/// so that a moved breast is cut by its frame and not by a line of its own.
double skin_radius(double theta);
/// The point of the skin line at theta.
Point<2> skin_point(double theta);
/// r(theta(x)) - |x - (0, 0.52)|: positive inside the breast; not the distance to the skin line but zero on
/// it.
double skin_depth(const Point<2>& x);
/// `count` >= 2 points of the skin line at equal steps of theta, first and last included.
Polyline skin_line(double first_theta, double last_theta, int count);
/// `count` >= 2 angles from -pi/2 to pi/2 at equal arc lengths of the skin line.
std::vector<double> skin_angles_by_length(int count);

/// Thickness of the compressed breast by its depth: sqrt(1 - (1 - d)^2), d = depth / 0.12 within 0 .. 1; 1 in
/// its middle, 0 at the skin line.
double breast_thickness(double depth);

/// Distance to the edge of the pectoral muscle, the line x / 0.26 + y / 0.42 = 1; positive in the muscle.
double pectoral_depth(const Point<2>& x);
/// The edge from x = `first_x` to the skin line: `count` >= 2 points at equal steps. At x = 0 is the chest
/// wall.
Polyline pectoral_line(double first_x, int count);

}  // namespace crease
