#include "Registration/LandmarkConstraints.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "Core/Error.h"
#include "Optimizers/ConstraintCompromise.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

template <int Dim>
std::string point_text(const Point<Dim>& p) {
  std::string text = "(";
  for (int a = 0; a < Dim; ++a) text += message(a > 0 ? ", " : "", p[a]);
  return text + ") mm";
}

/// Soft landmarks, too: nothing is known of the map out there.
template <int Dim>
void refuse_outside(const Landmarks<Dim>& landmarks, const SplineBasis<Dim>& basis,
                    const LandmarkWords& words) {
  for (std::size_t j = 0; j < landmarks.fixed.size(); ++j) {
    const Point<Dim>& p = landmarks.fixed[j];
    if (basis.contains(p)) continue;
    throw InvalidInput(
        message(words.one(static_cast<int>(j)), ": the fixed point ", point_text<Dim>(p), " lies ",
                (basis.nearest_point(p) - p).norm(),
                " mm outside the domain; move or delete it, or enlarge the region of "
                "interest"));
  }
}

template <int Dim>
void refuse_two_partners(const Landmarks<Dim>& landmarks, const std::vector<int>& chosen,
                         double tolerance, const LandmarkWords& words) {
  for (std::size_t a = 0; a < chosen.size(); ++a) {
    for (std::size_t b = a + 1; b < chosen.size(); ++b) {
      const auto i = static_cast<std::size_t>(chosen[a]), j = static_cast<std::size_t>(chosen[b]);
      if ((landmarks.fixed[i] - landmarks.fixed[j]).norm() > tolerance) continue;
      const double apart = (landmarks.moving[i] - landmarks.moving[j]).norm();
      if (apart <= tolerance) continue;
      throw InvalidInput(
          message(words.listed({chosen[a], chosen[b]}), " share the fixed point ",
                  point_text<Dim>(landmarks.fixed[i]), " but their partners are ", apart,
                  " mm apart: one point cannot go to two places; delete one of them"));
    }
  }
}

template <int Dim>
LinearConstraints rows_of(const Landmarks<Dim>& landmarks, const SplineBasis<Dim>& basis,
                          const AffineMap<Dim>& affine, const std::vector<int>& chosen) {
  LinearConstraints constraints;
  const auto r = std::ssize(chosen);
  constraints.d.resize(r, Dim);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::int64_t row = 0; row < r; ++row) {
    const auto j = static_cast<std::size_t>(chosen[static_cast<std::size_t>(row)]);
    const Point<Dim>& p = landmarks.fixed[j];
    const BasisValues<Dim> values = basis.evaluate(p);
    if (std::abs(values.values.sum() - 1) > 1e-9) {
      throw SolverError(message("landmark ", j + 1, " at ", point_text<Dim>(p),
                                ": the basis functions sum to ", values.values.sum(),
                                " instead of 1; move the landmark slightly and report this"));
    }
    for (std::size_t k = 0; k < values.control_points.size(); ++k) {
      entries.emplace_back(static_cast<int>(row), values.control_points[k],
                           values.values[static_cast<Eigen::Index>(k)]);
    }
    constraints.d.row(row) = (landmarks.moving[j] - affine(p)).transpose();
    constraints.names.push_back("landmark " + std::to_string(j + 1));
  }
  constraints.C.resize(r, basis.num_control_points());
  constraints.C.setFromTriplets(entries.begin(), entries.end());
  return constraints;
}

/// @param chosen  the landmark of each row.
std::vector<int> with_dependents(const DependentRow& row, const std::vector<int>& chosen) {
  std::vector<int> landmarks;
  for (int i : row.depends_on) landmarks.push_back(chosen[static_cast<std::size_t>(i)]);
  landmarks.erase(std::unique(landmarks.begin(), landmarks.end()), landmarks.end());
  return landmarks;
}

/// Where a landmark is: "(3, 4) mm, in triangle 57".
template <int Dim>
std::string place_text(const Point<Dim>& p, const SplineBasis<Dim>& basis) {
  std::string text = point_text<Dim>(p);
  const auto* triangular = dynamic_cast<const TriangularBSplineBasis<Dim>*>(&basis);
  if (triangular == nullptr) return text;
  return message(text, ", in ", Dim == 2 ? "triangle " : "tetrahedron ",
                 triangular->find_simplex(p));
}

/// @param place  says where a point is.
template <int Dim>
LandmarkContradiction contradiction(const std::vector<DependentRow>& rows,
                                    const std::vector<int>& chosen, const Landmarks<Dim>& landmarks,
                                    const std::function<std::string(const Point<Dim>&)>& place,
                                    const LandmarkWords& words) {
  constexpr std::size_t kMost = 5;
  std::set<int> all;
  std::string text = "the exact " + words.noun + "s contradict each other: ";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int landmark = chosen[static_cast<std::size_t>(rows[i].row)];
    const std::vector<int> others = with_dependents(rows[i], chosen);
    all.insert(landmark);
    all.insert(others.begin(), others.end());
    if (i >= kMost) continue;
    text += message(i > 0 ? "; " : "", words.one(landmark), " at ",
                    place(landmarks.fixed[static_cast<std::size_t>(landmark)]), ", misses what ",
                    words.listed(others), " imply by ", rows[i].residual.norm(), " mm");
  }
  if (rows.size() > kMost) text += message("; and ", rows.size() - kMost, " more");
  return {{all.begin(), all.end()}, std::move(text)};
}

/// What the affine map nearest to the displacements d gives the landmarks.
template <int Dim>
Eigen::MatrixXd nearest_affine(const Landmarks<Dim>& landmarks, const std::vector<int>& chosen,
                               const RowMatrix& d) {
  Eigen::MatrixXd points = Eigen::MatrixXd::Ones(d.rows(), Dim + 1);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    points.row(i).template head<Dim>() = landmarks.fixed[static_cast<std::size_t>(chosen[i])];
  }
  return points * points.completeOrthogonalDecomposition().solve(Eigen::MatrixXd(d));
}

/// A Phi that meets landmarks on average is not to be bent for what they nearly contradict each other in.
constexpr double kLeastShare = 0.5;

/// The null space with the contradicting landmarks replaced by what they agree on.
std::unique_ptr<NullSpace> agreed_null_space(const NullSpace& all,
                                             const LandmarkContradiction& contradicting,
                                             const std::vector<int>& chosen, NullSpaceKind kind) {
  std::vector<int> rows;
  for (int j : contradicting.landmarks) {
    const auto [first, last] = std::equal_range(chosen.begin(), chosen.end(), j);
    for (auto row = first; row != last; ++row) {
      rows.push_back(static_cast<int>(row - chosen.begin()));
    }
  }
  return make_null_space(kind, compromise(all.constraints(), rows, kLeastShare), all.num_rows());
}

/// Notes what is redundant, and refuses, or agrees on, what contradicts.
/// @param of_rows  the landmark of each row.
template <int Dim>
LandmarkConstraints<Dim> resolved(std::unique_ptr<NullSpace> null_space,
                                  const Landmarks<Dim>& landmarks, const std::vector<int>& of_rows,
                                  double tolerance, const LandmarkOptions& options,
                                  NullSpaceKind kind,
                                  const std::function<std::string(const Point<Dim>&)>& place) {
  LandmarkConstraints<Dim> result;
  const LandmarkWords& words = options.words;
  const DependentRowClasses classes = classify_dependent_rows(*null_space, tolerance);
  for (const DependentRow& row : classes.redundant) {
    std::string note =
        message(words.one(of_rows[static_cast<std::size_t>(row.row)]), " follows from ",
                words.listed(with_dependents(row, of_rows)), "; ignored");
    if (result.notes.empty() || result.notes.back() != note)
      result.notes.push_back(std::move(note));
  }
  result.contradictory = !classes.contradictory.empty();
  if (result.contradictory) {
    const auto found = contradiction<Dim>(classes.contradictory, of_rows, landmarks, place, words);
    if (options.conflict == LandmarkConflict::kError) {
      throw InvalidInput(message(found.text, "; ", words.remedies));
    }
    null_space = agreed_null_space(*null_space, found, of_rows, kind);
    result.notes.push_back(message(found.text, "; these ", found.landmarks.size(), " ", words.noun,
                                   "s are met in the least-squares sense"));
  }
  result.null_space = std::move(null_space);
  return result;
}

/// Rows for all coordinates of one landmark after the other.
template <int Dim>
LinearConstraints rows_of(const Landmarks<Dim>& landmarks, const Transform<Dim>& transform,
                          const std::vector<int>& chosen) {
  if (!transform.linear_in_parameters()) {
    throw InvalidInput(
        "exact landmarks need a transform that is linear in its parameters, which this one is not; "
        "give them a sigma (soft landmarks)");
  }
  std::vector<Point<Dim>> points;
  for (int j : chosen) points.push_back(landmarks.fixed[static_cast<std::size_t>(j)]);
  const Eigen::MatrixXd columns = transform.parameter_jacobian(points);
  LinearConstraints rows;
  rows.C = Eigen::MatrixXd(columns.transpose()).sparseView(1.0, 0.0);
  rows.d.resize(columns.cols(), 1);
  const Eigen::VectorXd at_rest = columns.transpose() * transform.parameters();
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto j = static_cast<std::size_t>(chosen[k]);
    const auto first = Dim * static_cast<Eigen::Index>(k);
    rows.d.template middleRows<Dim>(first) =
        landmarks.moving[j] - transform.map(points[k]) + at_rest.segment<Dim>(first);
    rows.names.insert(rows.names.end(), Dim, "landmark " + std::to_string(j + 1));
  }
  return rows;
}

}  // namespace

template <int Dim>
std::vector<int> exact_landmarks(const Landmarks<Dim>& landmarks, LandmarkMode mode) {
  std::vector<int> chosen;
  for (std::size_t j = 0; j < landmarks.fixed.size(); ++j) {
    const bool has_sigma = j < landmarks.sigma_mm.size() && std::isfinite(landmarks.sigma_mm[j]) &&
                           landmarks.sigma_mm[j] > 0;
    if (mode == LandmarkMode::kExact && !has_sigma) chosen.push_back(static_cast<int>(j));
  }
  return chosen;
}

template <int Dim>
std::optional<LandmarkContradiction> find_contradiction(const Landmarks<Dim>& landmarks,
                                                        const SplineBasis<Dim>& basis,
                                                        LandmarkMode mode) {
  const std::vector<int> chosen = exact_landmarks(landmarks, mode);
  const double tolerance = 1e-6 * basis.mean_edge_length();
  const LandmarkWords words;
  refuse_outside(landmarks, basis, words);
  refuse_two_partners(landmarks, chosen, tolerance, words);
  if (chosen.empty()) return std::nullopt;
  const auto null_space = make_null_space(NullSpaceKind::kElimination,
                                          rows_of(landmarks, basis, AffineMap<Dim>(), chosen),
                                          basis.num_control_points());
  const auto rows = classify_dependent_rows(*null_space, tolerance).contradictory;
  if (rows.empty()) return std::nullopt;
  return contradiction<Dim>(
      rows, chosen, landmarks, [&](const Point<Dim>& p) { return place_text<Dim>(p, basis); },
      words);
}

template <int Dim>
LandmarkStrain landmark_strain(const Landmarks<Dim>& landmarks, const SplineBasis<Dim>& basis,
                               LandmarkMode mode, double most) {
  const std::vector<int> chosen = exact_landmarks(landmarks, mode);
  LandmarkStrain strain;
  if (chosen.empty()) return strain;
  LinearConstraints rows = rows_of(landmarks, basis, AffineMap<Dim>(), chosen);
  rows.d -= nearest_affine(landmarks, chosen, rows.d);
  const double moved = rows.d.rowwise().norm().maxCoeff();
  if (!(moved > 1e-6 * basis.mean_edge_length())) return strain;
  // The offset of this null space is the smallest of all solutions.
  const auto null_space = make_null_space(NullSpaceKind::kQr, rows, basis.num_control_points());
  const Eigen::VectorXd shift = null_space->offset().rowwise().norm();
  strain.magnification = shift.maxCoeff() / moved;
  for (int i = 0; i < rows.C.rows(); ++i) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(rows.C, i); entry;
         ++entry) {
      if (shift[entry.col()] < most * moved) continue;
      strain.landmarks.push_back(chosen[static_cast<std::size_t>(i)]);
      break;
    }
  }
  return strain;
}

template <int Dim>
LandmarkConstraints<Dim> make_landmark_constraints(const Landmarks<Dim>& landmarks,
                                                   const SplineBasis<Dim>& basis,
                                                   const AffineMap<Dim>& affine,
                                                   const LandmarkOptions& options,
                                                   NullSpaceKind kind) {
  const std::vector<int> chosen = exact_landmarks(landmarks, options.mode);
  const double tolerance = 1e-6 * basis.mean_edge_length();
  refuse_outside(landmarks, basis, options.words);
  refuse_two_partners(landmarks, chosen, tolerance, options.words);

  LandmarkConstraints<Dim> result =
      resolved<Dim>(make_null_space(kind,
                                    chosen.empty() ? no_constraints(basis.num_control_points(), Dim)
                                                   : rows_of(landmarks, basis, affine, chosen),
                                    basis.num_control_points()),
                    landmarks, chosen, tolerance, options, kind,
                    [&](const Point<Dim>& p) { return place_text<Dim>(p, basis); });
  if (result.contradictory) return result;
  const auto strain = landmark_strain(landmarks, basis, options.mode, kLargestLandmarkStrain);
  if (strain.magnification > kLargestLandmarkStrain) {
    result.notes.push_back(message("exact ", options.words.listed(strain.landmarks),
                                   " nearly contradict each other: the map bends ",
                                   strain.magnification, " times as far as they move; ",
                                   options.words.remedies));
  }
  return result;
}

template <int Dim>
LandmarkConstraints<Dim> make_landmark_constraints(const Landmarks<Dim>& landmarks,
                                                   const Transform<Dim>& transform, double length,
                                                   const LandmarkOptions& options,
                                                   NullSpaceKind kind) {
  const std::vector<int> chosen = exact_landmarks(landmarks, options.mode);
  const double tolerance = 1e-6 * length;
  refuse_two_partners(landmarks, chosen, tolerance, options.words);
  if (chosen.empty()) {
    const auto none = no_constraints(transform.num_parameters());
    return {make_null_space(kind, none, transform.num_parameters()), {}, false};
  }
  LinearConstraints rows = rows_of(landmarks, transform, chosen);
  // Full rows, of landmarks that are no centres: each would fill a row of a sparse null space.
  const bool full = rows.C.nonZeros() > 2 * rows.C.rows();
  const NullSpaceKind used =
      full && kind == NullSpaceKind::kElimination ? NullSpaceKind::kQr : kind;
  std::vector<int> of_rows;
  for (int j : chosen) of_rows.insert(of_rows.end(), Dim, j);
  return resolved<Dim>(make_null_space(used, std::move(rows), transform.num_parameters()),
                       landmarks, of_rows, tolerance, options, used,
                       [](const Point<Dim>& p) { return point_text<Dim>(p); });
}

template <int Dim>
SoftLandmarks<Dim> soft_landmarks(const Landmarks<Dim>& landmarks, const LandmarkOptions& options) {
  const auto exact = exact_landmarks(landmarks, options.mode);
  SoftLandmarks<Dim> soft;
  for (std::size_t j = 0; j < landmarks.fixed.size(); ++j) {
    if (std::binary_search(exact.begin(), exact.end(), static_cast<int>(j))) continue;
    const bool own = j < landmarks.sigma_mm.size() && std::isfinite(landmarks.sigma_mm[j]);
    soft.fixed.push_back(landmarks.fixed[j]);
    soft.moving.push_back(landmarks.moving[j]);
    soft.sigma_mm.push_back(own ? landmarks.sigma_mm[j] : options.sigma_mm);
  }
  return soft;
}

template <int Dim>
std::shared_ptr<const LandmarkEnergy<Dim>> soft_landmark_energy(const Landmarks<Dim>& landmarks,
                                                                const SplineBasis<Dim>& basis,
                                                                const AffineMap<Dim>& affine,
                                                                const LandmarkOptions& options) {
  const SoftLandmarks<Dim> soft = soft_landmarks(landmarks, options);
  if (soft.fixed.empty()) return nullptr;
  return std::make_shared<const LandmarkEnergy<Dim>>(basis, affine, soft.fixed, soft.moving,
                                                     soft.sigma_mm);
}

template std::vector<int> exact_landmarks<2>(const Landmarks<2>&, LandmarkMode);
template std::vector<int> exact_landmarks<3>(const Landmarks<3>&, LandmarkMode);
template std::optional<LandmarkContradiction> find_contradiction<2>(const Landmarks<2>&,
                                                                    const SplineBasis<2>&,
                                                                    LandmarkMode);
template std::optional<LandmarkContradiction> find_contradiction<3>(const Landmarks<3>&,
                                                                    const SplineBasis<3>&,
                                                                    LandmarkMode);
template LandmarkStrain landmark_strain<2>(const Landmarks<2>&, const SplineBasis<2>&, LandmarkMode,
                                           double);
template LandmarkStrain landmark_strain<3>(const Landmarks<3>&, const SplineBasis<3>&, LandmarkMode,
                                           double);
template LandmarkConstraints<2> make_landmark_constraints<2>(const Landmarks<2>&,
                                                             const SplineBasis<2>&,
                                                             const AffineMap<2>&,
                                                             const LandmarkOptions&, NullSpaceKind);
template LandmarkConstraints<3> make_landmark_constraints<3>(const Landmarks<3>&,
                                                             const SplineBasis<3>&,
                                                             const AffineMap<3>&,
                                                             const LandmarkOptions&, NullSpaceKind);

template LandmarkConstraints<2> make_landmark_constraints<2>(const Landmarks<2>&,
                                                             const Transform<2>&, double,
                                                             const LandmarkOptions&, NullSpaceKind);
template LandmarkConstraints<3> make_landmark_constraints<3>(const Landmarks<3>&,
                                                             const Transform<3>&, double,
                                                             const LandmarkOptions&, NullSpaceKind);
template SoftLandmarks<2> soft_landmarks<2>(const Landmarks<2>&, const LandmarkOptions&);
template SoftLandmarks<3> soft_landmarks<3>(const Landmarks<3>&, const LandmarkOptions&);

template std::shared_ptr<const LandmarkEnergy<2>> soft_landmark_energy<2>(const Landmarks<2>&,
                                                                          const SplineBasis<2>&,
                                                                          const AffineMap<2>&,
                                                                          const LandmarkOptions&);
template std::shared_ptr<const LandmarkEnergy<3>> soft_landmark_energy<3>(const Landmarks<3>&,
                                                                          const SplineBasis<3>&,
                                                                          const AffineMap<3>&,
                                                                          const LandmarkOptions&);

}  // namespace crease
