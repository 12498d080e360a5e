#include "Registration/LandmarkConstraints.h"

#include <cmath>

#include "Core/Error.h"

namespace crease {
namespace {

/// "landmarks 3, 4 and 9", counted from 1 as in the file.
std::string listed(const std::vector<int>& landmarks) {
  std::string text = landmarks.size() == 1 ? "landmark " : "landmarks ";
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (i > 0) text += i + 1 == landmarks.size() ? " and " : ", ";
    text += std::to_string(landmarks[i] + 1);
  }
  return text;
}

template <int Dim>
std::string point_text(const Point<Dim>& p) {
  std::string text = "(";
  for (int a = 0; a < Dim; ++a) text += message(a > 0 ? ", " : "", p[a]);
  return text + ") mm";
}

template <int Dim>
void refuse_outside(const Landmarks<Dim>& landmarks, const SplineBasis<Dim>& basis,
                    const std::vector<int>& chosen) {
  for (int j : chosen) {
    const Point<Dim>& p = landmarks.fixed[static_cast<std::size_t>(j)];
    if (basis.contains(p)) continue;
    throw InvalidInput(
        message("landmark ", j + 1, ": the fixed point ", point_text<Dim>(p), " lies ",
                (basis.nearest_point(p) - p).norm(),
                " mm outside the domain; move or delete it, or enlarge the region of "
                "interest"));
  }
}

template <int Dim>
void refuse_two_partners(const Landmarks<Dim>& landmarks, const std::vector<int>& chosen,
                         double tolerance) {
  for (std::size_t a = 0; a < chosen.size(); ++a) {
    for (std::size_t b = a + 1; b < chosen.size(); ++b) {
      const auto i = static_cast<std::size_t>(chosen[a]), j = static_cast<std::size_t>(chosen[b]);
      if ((landmarks.fixed[i] - landmarks.fixed[j]).norm() > tolerance) continue;
      const double apart = (landmarks.moving[i] - landmarks.moving[j]).norm();
      if (apart <= tolerance) continue;
      throw InvalidInput(
          message(listed({chosen[a], chosen[b]}), " share the fixed point ",
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

std::vector<int> with_dependents(const DependentRow& row, const std::vector<int>& chosen) {
  std::vector<int> landmarks;
  for (int i : row.depends_on) landmarks.push_back(chosen[static_cast<std::size_t>(i)]);
  return landmarks;
}

std::string conflict_text(const std::vector<DependentRow>& rows, const std::vector<int>& chosen) {
  std::string text = "the exact landmarks contradict each other: ";
  for (std::size_t i = 0; i < rows.size() && i < 5; ++i) {
    if (i > 0) text += "; ";
    text += message("landmark ", chosen[static_cast<std::size_t>(rows[i].row)] + 1, " misses what ",
                    listed(with_dependents(rows[i], chosen)), " imply by ", rows[i].residual.norm(),
                    " mm");
  }
  if (rows.size() > 5) text += message("; and ", rows.size() - 5, " more");
  return text;
}

/// Distance of each landmark of the compromise from its partner: root mean square, mm.
double rms_residual(const NullSpace& null_space) {
  const RowMatrix residual =
      null_space.constraints().C * null_space.offset() - null_space.constraints().d;
  return std::sqrt(residual.squaredNorm() / static_cast<double>(residual.rows()));
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
LandmarkConstraints<Dim> make_landmark_constraints(const Landmarks<Dim>& landmarks,
                                                   const SplineBasis<Dim>& basis,
                                                   const AffineMap<Dim>& affine,
                                                   const LandmarkOptions& options,
                                                   NullSpaceKind kind) {
  const std::vector<int> chosen = exact_landmarks(landmarks, options.mode);
  const double tolerance = 1e-6 * basis.mean_edge_length();
  refuse_outside(landmarks, basis, chosen);
  refuse_two_partners(landmarks, chosen, tolerance);

  LandmarkConstraints<Dim> result;
  auto null_space = make_null_space(kind,
                                    chosen.empty() ? no_constraints(basis.num_control_points(), Dim)
                                                   : rows_of(landmarks, basis, affine, chosen),
                                    basis.num_control_points());
  const DependentRowClasses classes = classify_dependent_rows(*null_space, tolerance);
  for (const DependentRow& row : classes.redundant) {
    result.notes.push_back(message("landmark ", chosen[static_cast<std::size_t>(row.row)] + 1,
                                   " follows from ", listed(with_dependents(row, chosen)),
                                   "; ignored"));
  }
  if (!classes.contradictory.empty()) {
    const std::string conflict = conflict_text(classes.contradictory, chosen);
    if (options.conflict == LandmarkConflict::kError) {
      throw InvalidInput(message(conflict,
                                 "; give them a sigma (soft landmarks), use smaller triangles "
                                 "there (--mesh-size), or accept the least-squares compromise "
                                 "(--landmarks-conflict compromise)"));
    }
    null_space->use_least_squares_offset();
    result.notes.push_back(message(conflict, "; met in the least-squares sense, rms distance ",
                                   rms_residual(*null_space), " mm"));
  }
  result.null_space = std::move(null_space);
  return result;
}

template std::vector<int> exact_landmarks<2>(const Landmarks<2>&, LandmarkMode);
template std::vector<int> exact_landmarks<3>(const Landmarks<3>&, LandmarkMode);
template LandmarkConstraints<2> make_landmark_constraints<2>(const Landmarks<2>&,
                                                             const SplineBasis<2>&,
                                                             const AffineMap<2>&,
                                                             const LandmarkOptions&, NullSpaceKind);
template LandmarkConstraints<3> make_landmark_constraints<3>(const Landmarks<3>&,
                                                             const SplineBasis<3>&,
                                                             const AffineMap<3>&,
                                                             const LandmarkOptions&, NullSpaceKind);

}  // namespace crease
