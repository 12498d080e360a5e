#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "Applications/CertificateReport.h"
#include "Applications/FileInfo.h"
#include "Transforms/AffineEquivalent.h"
#include "Transforms/CauchyNavierTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TSplineBasis.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/ThinPlateBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"
#include "Transforms/TransformFile.h"

namespace crease {
namespace {

using Json = nlohmann::ordered_json;

template <int Dim>
void describe(const TensorBSplineBasis<Dim>& tensor, Json& json, std::string& text) {
  const auto& spans = tensor.lattice().spans;
  json["basis"] = "tensor";
  json["spans"] = std::vector<int>(spans.begin(), spans.end());
  text += fmt::format("  tensor-product B-spline, {} spans\n", fmt::join(spans, " x "));
}

template <int Dim>
void describe(const TriangularBSplineBasis<Dim>& triangular, Json& json, std::string& text) {
  const auto& net = triangular.net();
  const auto& regions = net.mesh.regions;
  const int bodies = regions.empty() ? 0 : *std::ranges::max_element(regions);
  json["basis"] = "triangular";
  json["simplices"] = net.mesh.simplices.size();
  json["vertices"] = net.mesh.vertices.size();
  json["crease_edges"] = net.crease_edges.size();
  json["bodies"] = bodies;
  text +=
      fmt::format("  triangular B-spline, {} {}, {} vertices, {} crease edges, {} rigid bodies\n",
                  net.mesh.simplices.size(), Dim == 2 ? "triangles" : "tetrahedra",
                  net.mesh.vertices.size(), net.crease_edges.size(), bodies);
}

template <int Dim>
void describe(const NurbsBasis<Dim>& nurbs, Json& json, std::string& text) {
  const auto size = nurbs.net_size();
  json["basis"] = "nurbs";
  json["functions"] = std::vector<int>(size.begin(), size.end());
  json["rational"] = nurbs.is_rational();
  text += fmt::format("  NURBS, {} functions, {}\n", fmt::join(size, " x "),
                      nurbs.is_rational() ? "rational" : "all weights equal");
}

template <int Dim>
void describe(const ThinPlateBasis<Dim>&, Json& json, std::string& text) {
  json["basis"] = "thin-plate";
  text += "  thin-plate spline, its control points are its centres\n";
}

void describe(const PowellSabinBasis& basis, Json& json, std::string& text) {
  const auto& mesh = basis.net().mesh;
  json["basis"] = "powell-sabin";
  json["simplices"] = mesh.simplices.size();
  json["vertices"] = mesh.vertices.size();
  text += fmt::format("  Powell-Sabin spline, {} triangles, {} vertices\n", mesh.simplices.size(),
                      mesh.vertices.size());
}

void describe(const TSplineBasis& basis, Json& json, std::string& text) {
  json["basis"] = "tspline";
  json["elements"] = basis.elements().size();
  text += fmt::format("  T-spline, {} Bezier elements\n", basis.elements().size());
}

/// Describes the basis where it is of the class.
template <typename Basis, int Dim>
void describe_if(const SplineBasis<Dim>& basis, Json& json, std::string& text) {
  if (const auto* found = dynamic_cast<const Basis*>(&basis)) describe(*found, json, text);
}

template <int Dim>
void describe_basis(const SplineBasis<Dim>& basis, Json& json, std::string& text) {
  json["degree"] = basis.degree();
  json["smoothness"] = basis.smoothness();
  json["control_points"] = basis.num_control_points();
  json["mean_edge_length_mm"] = basis.mean_edge_length();
  text += fmt::format(
      "  degree {}, C{} away from creases, {} control points, mean edge {:.4g} mm\n",
      basis.degree(), basis.smoothness(), basis.num_control_points(), basis.mean_edge_length());
  describe_if<TensorBSplineBasis<Dim>>(basis, json, text);
  describe_if<TriangularBSplineBasis<Dim>>(basis, json, text);
  describe_if<NurbsBasis<Dim>>(basis, json, text);
  describe_if<ThinPlateBasis<Dim>>(basis, json, text);
  if constexpr (Dim == 2) {
    describe_if<PowellSabinBasis>(basis, json, text);
    describe_if<TSplineBasis>(basis, json, text);
  }
}

template <int Dim>
void describe(const DisplacementFieldTransform<Dim>& field, Json& json, std::string& text) {
  const Raster<Dim>& raster = field.raster();
  const double largest = field.displacements().colwise().norm().maxCoeff();
  json["size"] = raster.size;
  json["spacing_mm"] = std::vector<double>(raster.spacing.begin(), raster.spacing.end());
  json["largest_displacement_mm"] = largest;
  text += fmt::format("  displacement field, {} samples, {} mm apart, up to {:.4g} mm\n",
                      fmt::join(raster.size, " x "),
                      numbers_text(raster.spacing.data(), Dim, " x "), largest);
}

template <int Dim>
void describe(const CauchyNavierTransform<Dim>& elastic, Json& json, std::string& text) {
  json["centres"] = elastic.centres().cols();
  json["poisson_ratio"] = elastic.poisson_ratio();
  text += fmt::format("  elastic body spline, {} centres, Poisson ratio {:.4g}\n",
                      elastic.centres().cols(), elastic.poisson_ratio());
}

template <int Dim>
void describe(const SimilarityTransform<Dim>& similarity, Json& json, std::string& text) {
  json["scale"] = similarity.scale();
  text += fmt::format("  scale {:.6g}\n", similarity.scale());
}

/// Rows of the matrix, then the offset: y = M x + t.
template <int Dim>
void describe(const AffineMap<Dim>& map, Json& json, std::string& text) {
  json["matrix"] = Json::array();
  for (int r = 0; r < Dim; ++r) {
    const Vector<Dim> row = map.linear.row(r);
    json["matrix"].push_back(std::vector<double>(row.begin(), row.end()));
    text += fmt::format("  ({})  {:+.6g} mm\n", numbers_text(row.data(), Dim, "  "), map.offset[r]);
  }
  json["offset_mm"] = std::vector<double>(map.offset.begin(), map.offset.end());
}

template <int Dim>
void describe_transform(const Transform<Dim>& transform, Json& json, std::string& text) {
  json["parameters"] = transform.num_parameters();
  if (const auto* spline = dynamic_cast<const SplineTransform<Dim>*>(&transform)) {
    describe_basis(spline->basis(), json, text);
  } else if (const auto* field = dynamic_cast<const DisplacementFieldTransform<Dim>*>(&transform)) {
    describe(*field, json, text);
  } else if (const auto* elastic = dynamic_cast<const CauchyNavierTransform<Dim>*>(&transform)) {
    describe(*elastic, json, text);
  } else if (const auto* chain = dynamic_cast<const CompositeTransform<Dim>*>(&transform)) {
    json["parts"] = Json::array();
    for (std::size_t k = 0; k < chain->num_parts(); ++k) {
      Json part = Json::object();
      text += fmt::format("part {}\n", k + 1);
      describe_transform(chain->part(k), part, text);
      json["parts"].push_back(part);
    }
  } else if (const auto affine = affine_equivalent(transform)) {
    describe(*affine, json, text);
    const auto* similarity = dynamic_cast<const SimilarityTransform<Dim>*>(&transform);
    if (similarity != nullptr) describe(*similarity, json, text);
  }
}

}  // namespace

FileInfo transform_info(const std::string& file) {
  const TransformFileInfo info = peek_transform(file);
  FileInfo result;
  result.figures = {{"kind", "transform"},
                    {"type", info.type},
                    {"format", info.format},
                    {"in_dimension", info.in_dim},
                    {"out_dimension", info.out_dim}};
  result.text = fmt::format("{} transform, {}D to {}D ({})\n", info.type, info.in_dim, info.out_dim,
                            info.format);
  if (info.in_dim != info.out_dim) return result;
  const auto add = [&](const auto& transform) {
    describe_transform(transform, result.figures, result.text);
    const auto certificate = certify_invertibility(transform);
    result.figures["jacobian"] = Json::object();
    add_certificate(certificate, result.figures["jacobian"]);
    result.text += "invertible: " + certificate_text(certificate) + "\n";
  };
  if (info.in_dim == 2) {
    add(*load_transform<2>(file));
  } else {
    add(*load_transform<3>(file));
  }
  return result;
}

}  // namespace crease
