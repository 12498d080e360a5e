#include "Transforms/ItkFiles/ItkLinear.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "Core/Error.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/RigidTransform.h"

namespace crease {
namespace {

/// x -> matrix (x - centre) + centre + translation.
template <int Dim>
struct Linear {
  Matrix<Dim> matrix = Matrix<Dim>::Identity();
  Vector<Dim> translation = Vector<Dim>::Zero();
  Point<Dim> centre = Point<Dim>::Zero();
  bool zyx = false;  // order of Euler's angles
};

/// Where a class keeps its centre; kNone: the origin.
enum class Centre { kNone, kFixed, kAmongParameters };

template <int Dim>
struct Kind {
  std::string_view name;
  int num_parameters;
  Centre centre;
  bool rigid;
  /// Reads the parameters p.
  void (*fill)(const double* p, Linear<Dim>& map);
};

template <int Dim>
Vector<Dim> vector_at(const double* p) {
  return Eigen::Map<const Vector<Dim>>(p);
}

template <int Dim>
Matrix<Dim> rows_at(const double* p) {
  return Eigen::Map<const Eigen::Matrix<double, Dim, Dim, Eigen::RowMajor>>(p);
}

Matrix<2> rotation(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return Matrix<2>{{c, -s}, {s, c}};
}

/// A rotation about one axis of space.
Matrix<3> rotation(int axis, double angle) {
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  Matrix<3> r = Matrix<3>::Identity();
  r(a, a) = r(b, b) = std::cos(angle);
  r(b, a) = std::sin(angle);
  r(a, b) = -r(b, a);
  return r;
}

Matrix<3> euler(const double* angles, bool zyx) {
  const Matrix<3> x = rotation(0, angles[0]), y = rotation(1, angles[1]),
                  z = rotation(2, angles[2]);
  return zyx ? z * y * x : z * x * y;
}

/// Of a quaternion with the vector part v and the real part w.
Matrix<3> quaternion(const Vector<3>& v, double w) {
  Matrix<3> r = 2 * v * v.transpose();
  r.diagonal().array() += w * w - v.squaredNorm();
  r += 2 * w * Matrix<3>{{0, -v[2], v[1]}, {v[2], 0, -v[0]}, {-v[1], v[0], 0}};
  return r;
}

/// A versor is the vector part of a unit quaternion whose real part is not negative. ITK shortens those of
/// length 1 and more; near that the real part depends on each rounding, so they are summed as there.
Matrix<3> versor(const double* p) {
  double norm = p[0] * p[0];
  norm += p[1] * p[1];
  norm += p[2] * p[2];
  norm = std::sqrt(norm);
  constexpr double kEpsilon = 1e-10;
  Vector<3> v = vector_at<3>(p);
  if (norm >= 1.0 - kEpsilon) v /= norm + kEpsilon * norm;
  double sine = v[0] * v[0];
  sine += v[1] * v[1];
  sine += v[2] * v[2];
  sine = std::sqrt(sine);
  return quaternion(v, std::sqrt(1.0 - sine * sine));
}

template <int Dim>
void fill_matrix(const double* p, Linear<Dim>& map) {
  map.matrix = rows_at<Dim>(p);
  map.translation = vector_at<Dim>(p + Dim * Dim);
}

void fill_versor(const double* p, Linear<3>& map) {
  map.matrix = versor(p);
  map.translation = vector_at<3>(p + 3);
}

void fill_scale_versor(const double* p, Linear<3>& map) {
  fill_versor(p, map);
  map.matrix.diagonal() += vector_at<3>(p + 6) - Vector<3>::Ones();
}

template <int Dim>
std::vector<Kind<Dim>> common_kinds() {
  constexpr int kMatrix = Dim * Dim + Dim;
  using L = Linear<Dim>;
  return {
      {"IdentityTransform", 0, Centre::kNone, false, [](const double*, L&) {}},
      {"TranslationTransform", Dim, Centre::kNone, false,
       [](const double* p, L& m) { m.translation = vector_at<Dim>(p); }},
      {"ScaleTransform", Dim, Centre::kFixed, false,
       [](const double* p, L& m) { m.matrix = vector_at<Dim>(p).asDiagonal(); }},
      {"ScaleLogarithmicTransform", Dim, Centre::kFixed, false,
       [](const double* p, L& m) {
         m.matrix = vector_at<Dim>(p).array().exp().matrix().asDiagonal();
       }},
      {"AffineTransform", kMatrix, Centre::kFixed, false, fill_matrix<Dim>},
      {"MatrixOffsetTransformBase", kMatrix, Centre::kFixed, false, fill_matrix<Dim>},
      // Dim more parameters, which nothing reads.
      {"FixedCenterOfRotationAffineTransform", kMatrix + Dim, Centre::kFixed, false,
       fill_matrix<Dim>},
      {"ScalableAffineTransform", kMatrix, Centre::kFixed, false, fill_matrix<Dim>},
      {"CenteredAffineTransform", kMatrix + Dim, Centre::kAmongParameters, false,
       [](const double* p, L& m) {
         m.matrix = rows_at<Dim>(p);
         m.centre = vector_at<Dim>(p + Dim * Dim);
         m.translation = vector_at<Dim>(p + Dim * Dim + Dim);
       }},
  };
}

std::vector<Kind<2>> own_kinds(Linear<2>) {
  using L = Linear<2>;
  const auto rigid = [](const double* p, L& m) {
    m.matrix = rotation(p[0]);
    m.translation = vector_at<2>(p + 1);
  };
  return {
      {"Euler2DTransform", 3, Centre::kFixed, true, rigid},
      {"Rigid2DTransform", 3, Centre::kFixed, true, rigid},
      {"CenteredRigid2DTransform", 5, Centre::kAmongParameters, true,
       [](const double* p, L& m) {
         m.matrix = rotation(p[0]);
         m.centre = vector_at<2>(p + 1);
         m.translation = vector_at<2>(p + 3);
       }},
      {"Similarity2DTransform", 4, Centre::kFixed, false,
       [](const double* p, L& m) {
         m.matrix = p[0] * rotation(p[1]);
         m.translation = vector_at<2>(p + 2);
       }},
      {"CenteredSimilarity2DTransform", 6, Centre::kAmongParameters, false,
       [](const double* p, L& m) {
         m.matrix = p[0] * rotation(p[1]);
         m.centre = vector_at<2>(p + 2);
         m.translation = vector_at<2>(p + 4);
       }},
  };
}

std::vector<Kind<3>> own_kinds(Linear<3>) {
  using L = Linear<3>;
  return {
      {"Euler3DTransform", 6, Centre::kFixed, true,
       [](const double* p, L& m) {
         m.matrix = euler(p, m.zyx);
         m.translation = vector_at<3>(p + 3);
       }},
      {"CenteredEuler3DTransform", 9, Centre::kAmongParameters, true,
       [](const double* p, L& m) {
         m.matrix = euler(p, m.zyx);
         m.centre = vector_at<3>(p + 3);
         m.translation = vector_at<3>(p + 6);
       }},
      // Read from a file, ITK's turns about the origin: it sets the centre before it knows the rotation.
      {"VersorTransform", 3, Centre::kNone, true,
       [](const double* p, L& m) { m.matrix = versor(p); }},
      {"VersorRigid3DTransform", 6, Centre::kFixed, true, fill_versor},
      {"QuaternionRigidTransform", 7, Centre::kFixed, true,
       [](const double* p, L& m) {
         m.matrix = quaternion(vector_at<3>(p), p[3]);
         m.translation = vector_at<3>(p + 4);
       }},
      {"Rigid3DTransform", 12, Centre::kFixed, true, fill_matrix<3>},
      {"Similarity3DTransform", 7, Centre::kFixed, false,
       [](const double* p, L& m) {
         fill_versor(p, m);
         m.matrix *= p[6];
       }},
      {"ScaleVersor3DTransform", 9, Centre::kFixed, false, fill_scale_versor},
      {"ScaleSkewVersor3DTransform", 15, Centre::kFixed, false,
       [](const double* p, L& m) {
         fill_scale_versor(p, m);
         m.matrix += Matrix<3>{{0, p[9], p[10]}, {p[11], 0, p[12]}, {p[13], p[14], 0}};
       }},
      {"ComposeScaleSkewVersor3DTransform", 12, Centre::kFixed, false,
       [](const double* p, L& m) {
         fill_versor(p, m);
         const Matrix<3> skew{{1, p[9], p[10]}, {0, 1, p[11]}, {0, 0, 1}};
         m.matrix = (m.matrix * vector_at<3>(p + 6).asDiagonal() * skew).eval();
       }},
  };
}

template <int Dim>
const Kind<Dim>* find_kind(std::string_view class_name) {
  static const std::vector<Kind<Dim>> kinds = [] {
    auto all = common_kinds<Dim>();
    const auto own = own_kinds(Linear<Dim>());
    all.insert(all.end(), own.begin(), own.end());
    return all;
  }();
  const auto at = std::ranges::find(kinds, class_name, &Kind<Dim>::name);
  return at == kinds.end() ? nullptr : &*at;
}

/// @throws InvalidInput unless both lists have as many finite numbers as the class wants.
template <int Dim>
void check(const Kind<Dim>& kind, const ItkTransform& transform) {
  if (transform.parameters.size() != kind.num_parameters) {
    throw InvalidInput(message("has ", transform.parameters.size(), " parameters instead of ",
                               kind.num_parameters));
  }
  if (!transform.parameters.allFinite() || !transform.fixed_parameters.allFinite()) {
    throw InvalidInput("has a parameter that is not finite");
  }
  const Eigen::Index fixed = transform.fixed_parameters.size();
  const bool has_order = kind.name.ends_with("Euler3DTransform");
  if (kind.centre == Centre::kFixed && fixed != Dim && !(has_order && fixed == Dim + 1)) {
    throw InvalidInput(message("has ", fixed, " fixed parameters instead of ", Dim));
  }
  if (kind.name == "VersorTransform" && transform.parameters.norm() > 1 + 1e-9) {
    throw InvalidInput("has a versor that is longer than 1");
  }
}

}  // namespace

template <int Dim>
bool is_itk_linear(std::string_view class_name) {
  return find_kind<Dim>(class_name) != nullptr;
}

template <int Dim>
bool is_itk_rigid(std::string_view class_name) {
  const auto* kind = find_kind<Dim>(class_name);
  return kind != nullptr && kind->rigid;
}

template <int Dim>
std::unique_ptr<Transform<Dim>> itk_linear(std::string_view class_name,
                                           const ItkTransform& transform) {
  const Kind<Dim>& kind = *find_kind<Dim>(class_name);
  check(kind, transform);
  const Eigen::VectorXd& fixed = transform.fixed_parameters;
  Linear<Dim> map;
  if (kind.centre == Centre::kFixed) map.centre = fixed.template head<Dim>();
  map.zyx = fixed.size() == Dim + 1 && fixed[Dim] != 0;
  kind.fill(transform.parameters.data(), map);
  const AffineMap<Dim> affine{map.matrix, map.centre + map.translation - map.matrix * map.centre};
  if (kind.rigid && map.matrix.isUnitary(1e-12) && map.matrix.determinant() > 0) {
    return std::make_unique<RigidTransform<Dim>>(affine, map.centre);
  }
  return std::make_unique<AffineTransform<Dim>>(affine, map.centre);
}

#define CREASE_INSTANTIATE(Dim)                       \
  template bool is_itk_linear<Dim>(std::string_view); \
  template bool is_itk_rigid<Dim>(std::string_view);  \
  template std::unique_ptr<Transform<Dim>> itk_linear<Dim>(std::string_view, const ItkTransform&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
