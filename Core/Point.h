#pragma once

#include <Eigen/Core>

namespace crease {

/// A position in mm (LPS, as ITK).
template <int Dim>
using Point = Eigen::Matrix<double, Dim, 1>;

/// A direction, displacement or force in mm.
template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

/// A Rows x Cols matrix of doubles.
template <int Rows, int Cols = Rows>
using Matrix = Eigen::Matrix<double, Rows, Cols>;

/// Control points of a map, one column each: Dim x n, mm.
template <int Dim>
using ControlPoints = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

}  // namespace crease
