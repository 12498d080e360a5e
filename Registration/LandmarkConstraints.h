#pragma once

#include <memory>
#include <string>
#include <vector>

#include "Optimizers/NullSpace.h"
#include "Registration/Landmarks.h"
#include "Transforms/AffineMap.h"
#include "Transforms/Splines/SplineBasis.h"

namespace crease {

enum class LandmarkMode { kExact, kSoft };
/// What to do with exact landmarks that contradict each other.
enum class LandmarkConflict { kError, kCompromise };

struct LandmarkOptions {
  LandmarkMode mode = LandmarkMode::kExact;
  LandmarkConflict conflict = LandmarkConflict::kError;
  double sigma_mm = 1;  ///< soft landmarks without a sigma of their own
  double weight = 1;    ///< lambda of the soft landmarks
};

/// Exact landmarks as linear constraints on the control points, T(p_j) = q_j, and their null space.
template <int Dim>
struct LandmarkConstraints {
  std::shared_ptr<const NullSpace> null_space;
  std::vector<std::string> notes;  ///< redundant landmarks, compromises
};

/// Numbers of the landmarks that are to be met exactly: all without a sigma, none in soft mode.
template <int Dim>
std::vector<int> exact_landmarks(const Landmarks<Dim>& landmarks, LandmarkMode mode);

/// @throws InvalidInput when a landmark lies outside the domain (with its distance), two share a fixed
/// point but not their partner, or landmarks contradict each other and the policy is kError; the
/// message lists the landmarks of the conflict, the residual in mm and the remedies.
template <int Dim>
LandmarkConstraints<Dim> make_landmark_constraints(const Landmarks<Dim>& landmarks,
                                                   const SplineBasis<Dim>& basis,
                                                   const AffineMap<Dim>& affine,
                                                   const LandmarkOptions& options,
                                                   NullSpaceKind kind);

extern template std::vector<int> exact_landmarks<2>(const Landmarks<2>&, LandmarkMode);
extern template std::vector<int> exact_landmarks<3>(const Landmarks<3>&, LandmarkMode);
extern template LandmarkConstraints<2> make_landmark_constraints<2>(const Landmarks<2>&,
                                                                    const SplineBasis<2>&,
                                                                    const AffineMap<2>&,
                                                                    const LandmarkOptions&,
                                                                    NullSpaceKind);
extern template LandmarkConstraints<3> make_landmark_constraints<3>(const Landmarks<3>&,
                                                                    const SplineBasis<3>&,
                                                                    const AffineMap<3>&,
                                                                    const LandmarkOptions&,
                                                                    NullSpaceKind);

}  // namespace crease
