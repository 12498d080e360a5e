#pragma once

#include "Core/Point.h"

namespace crease {

/// Rotations by their angles (radians): 2D the angle from the first axis to the second, 3D the rotation
/// vector, its length the angle and its direction the axis.
template <int Dim>
using RotationAngles = Eigen::Matrix<double, Dim == 2 ? 1 : 3, 1>;

template <int Dim>
Matrix<Dim> rotation_matrix(const RotationAngles<Dim>& angles);

/// The angles of a rotation, turned by half a turn at most.
template <int Dim>
RotationAngles<Dim> rotation_angles(const Matrix<Dim>& rotation);

/// d(R(angles) v)/dangles for R = rotation_matrix(angles).
template <int Dim>
Eigen::Matrix<double, Dim, RotationAngles<Dim>::RowsAtCompileTime> rotated_by_angles(
    const Matrix<Dim>& rotation, const RotationAngles<Dim>& angles, const Vector<Dim>& v);

/// The rotation R for which |R - matrix| is smallest.
template <int Dim>
Matrix<Dim> nearest_rotation(const Matrix<Dim>& matrix);

/// Whether a matrix is a rotation, to 1e-9.
template <int Dim>
bool is_rotation(const Matrix<Dim>& matrix);

}  // namespace crease
