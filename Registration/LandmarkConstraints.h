#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "Optimizers/NullSpace.h"
#include "Registration/LandmarkWords.h"
#include "Registration/Landmarks.h"
#include "Transforms/AffineMap.h"
#include "Transforms/Energies/LandmarkEnergy.h"
#include "Transforms/Splines/SplineBasis.h"
#include "Transforms/Transform.h"

namespace crease {

/// Landmarks without a sigma of their own: met exactly, or up to their uncertainty.
enum class LandmarkMode { kExact, kSoft };
/// What to do with exact landmarks that contradict each other.
enum class LandmarkConflict { kError, kCompromise };

/// How landmarks are to be met.
struct LandmarkOptions {
  LandmarkMode mode = LandmarkMode::kExact;
  LandmarkConflict conflict = LandmarkConflict::kError;
  double sigma_mm = 1;       ///< soft landmarks without a sigma of their own
  double weight = 1;         ///< lambda of the soft landmarks
  LandmarkWords words = {};  ///< of messages
};

/// Exact landmarks as linear constraints on the control points, T(p_j) = q_j, and their null space.
template <int Dim>
struct LandmarkConstraints {
  std::shared_ptr<const NullSpace> null_space;
  std::vector<std::string> notes;  ///< redundant landmarks, compromises
  bool contradictory = false;      ///< some did, and are met as well as they can be
};

/// Exact landmarks that splines of a basis cannot meet together.
struct LandmarkContradiction {
  std::vector<int> landmarks;  ///< numbers (from 0) of all that take part, ascending
  std::string text;            ///< names them, where they are, and what is missed, mm
};

/// Numbers of the landmarks that are to be met exactly: all without a sigma, none in soft mode.
template <int Dim>
std::vector<int> exact_landmarks(const Landmarks<Dim>& landmarks, LandmarkMode mode);

/// The exact landmarks that contradict each other, if any do. The affine map of a run does not matter:
/// splines contain the affine maps.
/// @throws InvalidInput when a landmark lies outside the domain (with its distance), or two share a
/// fixed point but not their partner.
template <int Dim>
std::optional<LandmarkContradiction> find_contradiction(const Landmarks<Dim>& landmarks,
                                                        const SplineBasis<Dim>& basis,
                                                        LandmarkMode mode);

/// From this magnification on, exact landmarks are said to contradict each other nearly: the map bends out of
/// all proportion.
inline constexpr double kLargestLandmarkStrain = 30;

/// Exact landmarks that can be met, but nearly contradict each other.
struct LandmarkStrain {
  /// How far control points must move, over how far the landmarks themselves move, both apart from the
  /// affine map that is nearest to them: a few units where landmarks agree, more and more the more nearly
  /// they contradict each other. 0 without exact landmarks.
  double magnification = 0;
  std::vector<int> landmarks;  ///< numbers (from 0) of those near control points that move too far
};

/// @param most  the magnification from which on landmarks are named.
template <int Dim>
LandmarkStrain landmark_strain(const Landmarks<Dim>& landmarks, const SplineBasis<Dim>& basis,
                               LandmarkMode mode, double most);

/// @throws InvalidInput as find_contradiction(), and when landmarks contradict each other and the
/// policy is kError; the message lists the landmarks of the conflict, the residual in mm and the remedies.
template <int Dim>
LandmarkConstraints<Dim> make_landmark_constraints(const Landmarks<Dim>& landmarks,
                                                   const SplineBasis<Dim>& basis,
                                                   const AffineMap<Dim>& affine,
                                                   const LandmarkOptions& options,
                                                   NullSpaceKind kind);

/// The same for a transform that is linear in its parameters, as equations for all of these in one
/// vector: Dim for each landmark.
/// @param length  mm: landmarks that contradict each other by less than a millionth of it do not.
/// @throws InvalidInput likewise, and when there are exact landmarks and the transform is not linear.
template <int Dim>
LandmarkConstraints<Dim> make_landmark_constraints(const Landmarks<Dim>& landmarks,
                                                   const Transform<Dim>& transform, double length,
                                                   const LandmarkOptions& options,
                                                   NullSpaceKind kind);

/// Landmarks that are met only up to their uncertainty, one entry each.
template <int Dim>
struct SoftLandmarks {
  std::vector<Point<Dim>> fixed, moving;  ///< mm
  std::vector<double> sigma_mm;           ///< their own, else the option's
};

template <int Dim>
SoftLandmarks<Dim> soft_landmarks(const Landmarks<Dim>& landmarks, const LandmarkOptions& options);

/// The energy of the landmarks that are met only up to their uncertainty (their own sigma_mm, else the
/// option's); null where there are none.
template <int Dim>
std::shared_ptr<const LandmarkEnergy<Dim>> soft_landmark_energy(const Landmarks<Dim>& landmarks,
                                                                const SplineBasis<Dim>& basis,
                                                                const AffineMap<Dim>& affine,
                                                                const LandmarkOptions& options);

extern template std::vector<int> exact_landmarks<2>(const Landmarks<2>&, LandmarkMode);
extern template std::vector<int> exact_landmarks<3>(const Landmarks<3>&, LandmarkMode);
extern template std::optional<LandmarkContradiction> find_contradiction<2>(const Landmarks<2>&,
                                                                           const SplineBasis<2>&,
                                                                           LandmarkMode);
extern template std::optional<LandmarkContradiction> find_contradiction<3>(const Landmarks<3>&,
                                                                           const SplineBasis<3>&,
                                                                           LandmarkMode);
extern template LandmarkStrain landmark_strain<2>(const Landmarks<2>&, const SplineBasis<2>&,
                                                  LandmarkMode, double);
extern template LandmarkStrain landmark_strain<3>(const Landmarks<3>&, const SplineBasis<3>&,
                                                  LandmarkMode, double);
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
extern template LandmarkConstraints<2> make_landmark_constraints<2>(const Landmarks<2>&,
                                                                    const Transform<2>&, double,
                                                                    const LandmarkOptions&,
                                                                    NullSpaceKind);
extern template LandmarkConstraints<3> make_landmark_constraints<3>(const Landmarks<3>&,
                                                                    const Transform<3>&, double,
                                                                    const LandmarkOptions&,
                                                                    NullSpaceKind);
extern template SoftLandmarks<2> soft_landmarks<2>(const Landmarks<2>&, const LandmarkOptions&);
extern template SoftLandmarks<3> soft_landmarks<3>(const Landmarks<3>&, const LandmarkOptions&);
extern template std::shared_ptr<const LandmarkEnergy<2>> soft_landmark_energy<2>(
    const Landmarks<2>&, const SplineBasis<2>&, const AffineMap<2>&, const LandmarkOptions&);
extern template std::shared_ptr<const LandmarkEnergy<3>> soft_landmark_energy<3>(
    const Landmarks<3>&, const SplineBasis<3>&, const AffineMap<3>&, const LandmarkOptions&);

}  // namespace crease
