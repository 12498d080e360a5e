#include "Transforms/TransformFile.h"

#include <fstream>
#include <limits>

#include "Core/WholeFile.h"
#include "Transforms/AffineTransform.h"
#include "Transforms/Base64.h"
#include "Transforms/CauchyNavierTransform.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/ItkFiles/ItkConversion.h"
#include "Transforms/ItkFiles/ReadItkFile.h"
#include "Transforms/JsonReader.h"
#include "Transforms/RigidTransform.h"
#include "Transforms/SimilarityTransform.h"
#include "Transforms/SplineBasisFile.h"
#include "Transforms/SplineTransform.h"

namespace crease {
namespace {

using Json = nlohmann::json;
constexpr auto kFormat = "crease transform";
constexpr int kVersion = 1;

template <typename Derived>
Json list(const Eigen::MatrixBase<Derived>& values) {
  Json numbers = Json::array();
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    for (Eigen::Index r = 0; r < values.rows(); ++r) numbers.push_back(values(r, c));
  }
  return numbers;
}

template <int InDim, int OutDim>
Json spline_entries(const SplineTransform<InDim, OutDim>& spline) {
  return {{"type", "spline"},
          {"affine_matrix_rows", list(spline.affine().linear.transpose())},
          {"affine_offset", list(spline.affine().offset)},
          {"basis", basis_to_json(spline.basis())},
          {"control_points", list(spline.control_points())}};
}

template <int Dim>
Json field_entries(const DisplacementFieldTransform<Dim>& field) {
  const Raster<Dim>& raster = field.raster();
  const EncodedNumbers numbers =
      encode_numbers({field.displacements().data(), std::size_t(field.displacements().size())});
  return {{"type", "displacement field"},
          {"size", raster.size},
          {"origin", list(raster.origin)},
          {"spacing", list(raster.spacing)},
          {"direction_columns", list(raster.direction)},
          {"displacements", {{"encoding", "base64 " + numbers.type}, {"data", numbers.text}}}};
}

template <typename Kind>
Json linear_entries(const char* type, const Kind& transform) {
  return {{"type", type},
          {"centre", list(transform.centre())},
          {"parameters", list(transform.parameters())}};
}

template <int Dim>
Json elastic_entries(const CauchyNavierTransform<Dim>& body) {
  return {{"type", "cauchy-navier"},
          {"affine_matrix_rows", list(body.affine().linear.transpose())},
          {"affine_offset", list(body.affine().offset)},
          {"poisson_ratio", body.poisson_ratio()},
          {"centres", list(body.centres())},
          {"displacements", list(body.displacements())}};
}

template <int InDim, int OutDim>
Json entries(const Transform<InDim, OutDim>& transform) {
  if (const auto* spline = dynamic_cast<const SplineTransform<InDim, OutDim>*>(&transform)) {
    return spline_entries(*spline);
  }
  if constexpr (InDim == OutDim) {
    if (const auto* affine = dynamic_cast<const AffineTransform<InDim>*>(&transform)) {
      return linear_entries("affine", *affine);
    }
    if (const auto* rigid = dynamic_cast<const RigidTransform<InDim>*>(&transform)) {
      return linear_entries("rigid", *rigid);
    }
    if (const auto* similarity = dynamic_cast<const SimilarityTransform<InDim>*>(&transform)) {
      return linear_entries("similarity", *similarity);
    }
    if (const auto* body = dynamic_cast<const CauchyNavierTransform<InDim>*>(&transform)) {
      return elastic_entries(*body);
    }
    if (const auto* field = dynamic_cast<const DisplacementFieldTransform<InDim>*>(&transform)) {
      return field_entries(*field);
    }
    if (const auto* composite = dynamic_cast<const CompositeTransform<InDim>*>(&transform)) {
      Json parts = Json::array();
      for (std::size_t k = 0; k < composite->num_parts(); ++k) {
        parts.push_back(entries(composite->part(k)));
      }
      return {{"type", "composite"}, {"parts", parts}};
    }
  }
  throw InvalidInput("save_transform: transforms of this class cannot be written to a file.");
}

template <int Dim, typename Kind>
std::unique_ptr<Transform<Dim>> read_linear(const JsonReader& reader) {
  auto transform = std::make_unique<Kind>(Point<Dim>(reader.at("centre").numbers<Dim>()));
  transform->set_parameters(
      reader.at("parameters").numbers<1, Eigen::Dynamic>(transform->num_parameters()).transpose());
  return transform;
}

template <int InDim, int OutDim>
AffineMap<InDim, OutDim> read_affine_part(const JsonReader& reader) {
  AffineMap<InDim, OutDim> affine;
  affine.linear = reader.at("affine_matrix_rows").numbers<InDim, OutDim>().transpose();
  affine.offset = reader.at("affine_offset").numbers<OutDim>();
  return affine;
}

template <int Dim>
std::unique_ptr<Transform<Dim>> read_elastic(const JsonReader& reader) {
  const auto n = static_cast<Eigen::Index>(reader.at("centres").size() / Dim);
  auto transform = std::make_unique<CauchyNavierTransform<Dim>>(
      reader.at("centres").numbers<Dim, Eigen::Dynamic>(n), reader.at("poisson_ratio").number(),
      read_affine_part<Dim, Dim>(reader));
  transform->set_parameters(reader.at("displacements").numbers<Dim, Eigen::Dynamic>(n).reshaped());
  return transform;
}

template <int InDim, int OutDim>
std::unique_ptr<Transform<InDim, OutDim>> read_spline(const JsonReader& reader) {
  const auto affine = read_affine_part<InDim, OutDim>(reader);
  auto basis = basis_from_json<InDim>(reader.at("basis"));
  const int n = basis->num_control_points();
  auto transform = std::make_unique<SplineTransform<InDim, OutDim>>(std::move(basis), affine);
  transform->set_control_points(reader.at("control_points").numbers<OutDim, Eigen::Dynamic>(n));
  return transform;
}

template <int Dim>
std::unique_ptr<Transform<Dim>> read_field(const JsonReader& reader) {
  Raster<Dim> raster;
  const JsonReader size = reader.at("size");
  if (size.size() != Dim) size.fail_here(message("does not have ", Dim, " numbers"));
  for (int a = 0; a < Dim; ++a) {
    raster.size[a] = size.at(std::size_t(a)).integer(1, std::numeric_limits<int>::max());
  }
  raster.origin = reader.at("origin").numbers<Dim>();
  raster.spacing = reader.at("spacing").numbers<Dim>();
  raster.direction = reader.at("direction_columns").numbers<Dim, Dim>();
  const JsonReader displacements = reader.at("displacements");
  const std::string encoding = displacements.at("encoding").text();
  constexpr std::string_view kBase64 = "base64 ";
  const auto numbers =
      encoding.starts_with(kBase64)
          ? decode_numbers(encoding.substr(kBase64.size()), displacements.at("data").text())
          : std::nullopt;
  if (!numbers) displacements.fail_here(message("is not ", encoding, ", or is cut off"));
  double wanted = Dim;
  for (int samples : raster.size) wanted *= samples;
  if (static_cast<double>(numbers->size()) != wanted) {
    displacements.fail_here(message("has ", numbers->size(), " numbers instead of ", wanted));
  }
  return std::make_unique<DisplacementFieldTransform<Dim>>(
      raster, Eigen::Map<const ControlPoints<Dim>>(numbers->data(), Dim, raster.num_samples()));
}

template <int InDim, int OutDim>
std::unique_ptr<Transform<InDim, OutDim>> read(const JsonReader& reader) {
  const std::string type = reader.at("type").text();
  if (type == "spline") return read_spline<InDim, OutDim>(reader);
  if constexpr (InDim == OutDim) {
    if (type == "affine") return read_linear<InDim, AffineTransform<InDim>>(reader);
    if (type == "rigid") return read_linear<InDim, RigidTransform<InDim>>(reader);
    if (type == "displacement field") return read_field<InDim>(reader);
    if (type == "similarity") return read_linear<InDim, SimilarityTransform<InDim>>(reader);
    if (type == "cauchy-navier") return read_elastic<InDim>(reader);
    if (type == "composite") {
      const JsonReader list = reader.at("parts");
      std::vector<std::unique_ptr<Transform<InDim>>> parts;
      for (std::size_t k = 0; k < list.size(); ++k) parts.push_back(read<InDim, InDim>(list.at(k)));
      return std::make_unique<CompositeTransform<InDim>>(std::move(parts));
    }
  }
  reader.fail(message("the transform type \"", type, "\" is unknown"));
}

Json parse(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw FileError(message(file.string(), ": cannot be opened."));
  try {
    return Json::parse(stream);
  } catch (const Json::exception& error) {
    throw FileError(message(file.string(), ": is not a complete JSON file (", error.what(), ")."));
  }
}

TransformFileInfo read_info(const JsonReader& reader) {
  if (!reader.has("format") || reader.at("format").text() != kFormat) {
    reader.fail(message("is not a transform file: \"format\" is not \"", kFormat, "\""));
  }
  const int version = reader.at("version").integer(1, std::numeric_limits<int>::max());
  if (version > kVersion) {
    reader.fail(message("has version ", version, "; this program reads versions up to ", kVersion));
  }
  const JsonReader dimensions = reader.at("dimensions");
  if (dimensions.size() != 2) reader.fail("the entry \"dimensions\" is not a pair");
  return {dimensions.at(std::size_t{0}).integer(2, 3), dimensions.at(std::size_t{1}).integer(2, 3),
          reader.at("type").text(), "crease"};
}

}  // namespace

template <int InDim, int OutDim>
void save_transform(const Transform<InDim, OutDim>& transform, const std::filesystem::path& file) {
  Json json = entries(transform);
  json["format"] = kFormat;
  json["version"] = kVersion;
  json["dimensions"] = {InDim, OutDim};
  write_whole_file(file, json.dump(1) + '\n');
}

TransformFileInfo peek_transform(const std::filesystem::path& file) {
  if (is_itk_file(file)) {
    const ItkTransformList list = read_itk_file(file);
    const ItkSummary summary = summary_of(list);
    return {summary.dimension, summary.dimension, summary.type, list.format};
  }
  const Json json = parse(file);
  return read_info(JsonReader(json, file.string()));
}

template <int InDim, int OutDim>
std::unique_ptr<Transform<InDim, OutDim>> load_transform(const std::filesystem::path& file) {
  if (is_itk_file(file)) {
    if constexpr (InDim == OutDim) return from_itk<InDim>(read_itk_file(file));
    throw FileError(message(file.string(), ": is a file of ITK; a surface is needed."));
  }
  const Json json = parse(file);
  const JsonReader reader(json, file.string());
  const auto info = read_info(reader);
  if (info.in_dim != InDim || info.out_dim != OutDim) {
    reader.fail(message("holds a transform from ", info.in_dim, "D to ", info.out_dim,
                        "D; one from ", InDim, "D to ", OutDim, "D is needed"));
  }
  try {
    return read<InDim, OutDim>(reader);
  } catch (const InvalidInput& error) {
    reader.fail(message("its contents contradict each other: ", error.what()));
  }
}

template void save_transform(const Transform<2, 2>&, const std::filesystem::path&);
template void save_transform(const Transform<3, 3>&, const std::filesystem::path&);
template void save_transform(const Transform<2, 3>&, const std::filesystem::path&);
template std::unique_ptr<Transform<2, 2>> load_transform(const std::filesystem::path&);
template std::unique_ptr<Transform<3, 3>> load_transform(const std::filesystem::path&);
template std::unique_ptr<Transform<2, 3>> load_transform(const std::filesystem::path&);

}  // namespace crease
