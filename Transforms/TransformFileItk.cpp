#include "Transforms/TransformFileItk.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <charconv>
#include <string>
#include <vector>

#include "Core/Error.h"
#include "Core/WholeFile.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/ItkFiles/ItkTransform.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

/// What acts first comes first.
using ItkParts = std::vector<ItkTransform>;

template <int Dim>
std::string itk_name(const std::string& name) {
  return message(name, "Transform_double_", Dim, "_", Dim);
}

template <int Dim>
ItkTransform to_itk(const AffineTransform<Dim>& affine) {
  return {itk_name<Dim>("Affine"), affine.centre(), affine.parameters()};
}

ItkTransform to_itk(const RigidTransform<2>& rigid) {
  return {itk_name<2>("Euler2D"), rigid.centre(), rigid.parameters()};
}

/// ITK's rotation is Rz Rx Ry.
ItkTransform to_itk(const RigidTransform<3>& rigid) {
  const Vector<3> zxy = rigid.rotation().eulerAngles(2, 0, 1);
  Eigen::VectorXd parameters(6);
  parameters << zxy[1], zxy[2], zxy[0], rigid.translation();
  return {itk_name<3>("Euler3D"), rigid.centre(), parameters};
}

/// ITK's [size, origin, spacing, direction by rows].
template <int Dim>
Eigen::VectorXd itk_grid(const Raster<Dim>& raster) {
  Eigen::VectorXd numbers(Dim * (3 + Dim));
  for (int a = 0; a < Dim; ++a) numbers[a] = raster.size[a];
  numbers.tail(Dim * (2 + Dim)) << raster.origin, raster.spacing,
      raster.direction.transpose().reshaped();
  return numbers;
}

template <int Dim>
ItkTransform to_itk(const DisplacementFieldTransform<Dim>& field) {
  return {itk_name<Dim>("DisplacementField"), itk_grid(field.raster()), field.parameters()};
}

ItkTransform to_itk(const SimilarityTransform<2>& similarity) {
  Eigen::VectorXd parameters(4);
  parameters << similarity.scale(), similarity.angles(), similarity.translation();
  return {itk_name<2>("Similarity2D"), similarity.centre(), parameters};
}

/// ITK's Similarity3DTransform has a versor, which loses half its digits near half turns.
ItkTransform to_itk(const SimilarityTransform<3>& similarity) {
  return to_itk(AffineTransform<3>(similarity.affine_map(), similarity.centre()));
}

/// x + v(x). @param v  control points; @param basis  of degree 1 to 3.
template <int Dim>
ItkTransform to_itk(const TensorBSplineBasis<Dim>& basis, const ControlPoints<Dim>& v) {
  ItkTransform spline{itk_name<Dim>("BSpline"), itk_grid(basis.control_raster()), {}};
  if (basis.degree() != 3) spline.name += message("_", basis.degree());
  const Eigen::MatrixXd components = v.transpose();  // one after the other
  spline.parameters = components.reshaped();
  return spline;
}

/// @return whether ITK has such parts.
template <int Dim>
bool append_spline(const SplineTransform<Dim>& spline, ItkParts& parts) {
  const auto* basis = dynamic_cast<const TensorBSplineBasis<Dim>*>(&spline.basis());
  if (basis == nullptr || basis->degree() > 3) return false;
  const AffineMap<Dim>& a = spline.affine();
  if (a.linear == Matrix<Dim>::Identity() && a.offset == Vector<Dim>::Zero()) {
    parts.push_back(to_itk(*basis, spline.control_points()));
    return true;
  }
  const Eigen::FullPivLU<Matrix<Dim>> lu(a.linear);
  if (!lu.isInvertible()) return false;
  parts.push_back(to_itk<Dim>(*basis, lu.solve(spline.control_points())));
  parts.push_back(to_itk(AffineTransform<Dim>(a)));
  return true;
}

template <int Dim>
bool append(const Transform<Dim>& transform, ItkParts& parts) {
  if (const auto* spline = dynamic_cast<const SplineTransform<Dim>*>(&transform)) {
    return append_spline(*spline, parts);
  }
  if (const auto* affine = dynamic_cast<const AffineTransform<Dim>*>(&transform)) {
    parts.push_back(to_itk(*affine));
    return true;
  }
  if (const auto* rigid = dynamic_cast<const RigidTransform<Dim>*>(&transform)) {
    parts.push_back(to_itk(*rigid));
    return true;
  }
  if (const auto* field = dynamic_cast<const DisplacementFieldTransform<Dim>*>(&transform)) {
    parts.push_back(to_itk(*field));
    return true;
  }
  if (const auto* similarity = dynamic_cast<const SimilarityTransform<Dim>*>(&transform)) {
    parts.push_back(to_itk(*similarity));
    return true;
  }
  const auto* composite = dynamic_cast<const CompositeTransform<Dim>*>(&transform);
  if (composite == nullptr) return false;
  for (std::size_t k = 0; k < composite->num_parts(); ++k) {
    if (!append(composite->part(k), parts)) return false;
  }
  return composite->num_parts() > 0;
}

/// "label: 1 0.5 ...", every number in the fewest digits that give it back.
std::string line(const std::string& label, const Eigen::VectorXd& numbers) {
  std::string text = label + ":";
  std::array<char, 32> digits;
  for (const double number : numbers) {
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    text += ' ';
    text.append(digits.data(), end);
  }
  return text + '\n';
}

/// ITK applies the last transform of a file first.
template <int Dim>
std::string file_text(const ItkParts& parts) {
  std::string text = "#Insight Transform File V1.0\n";
  int count = 0;
  const auto begin = [&](const std::string& name) {
    text += message("#Transform ", count++, "\nTransform: ", name, "\n");
  };
  if (parts.size() > 1) begin(itk_name<Dim>("Composite"));
  for (auto part = parts.rbegin(); part != parts.rend(); ++part) {
    begin(part->name);
    text += line("Parameters", part->parameters);
    text += line("FixedParameters", part->fixed_parameters);
  }
  return text;
}

}  // namespace

template <int Dim>
bool has_itk_equivalent(const Transform<Dim>& transform) {
  ItkParts parts;
  return append(transform, parts);
}

template <int Dim>
void save_itk_transform(const Transform<Dim>& transform, const std::filesystem::path& file) {
  ItkParts parts;
  if (!append(transform, parts)) {
    throw InvalidInput(message(file.string(),
                               ": ITK has no transform like this one; save it as JSON, or its "
                               "displacement field as an image."));
  }
  write_whole_file(file, file_text<Dim>(parts));
}

template bool has_itk_equivalent(const Transform<2>&);
template bool has_itk_equivalent(const Transform<3>&);
template void save_itk_transform(const Transform<2>&, const std::filesystem::path&);
template void save_itk_transform(const Transform<3>&, const std::filesystem::path&);

}  // namespace crease
