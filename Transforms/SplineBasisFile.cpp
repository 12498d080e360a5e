#include "Transforms/SplineBasisFile.h"

#include <limits>

#include "Transforms/Splines/NurbsBasis.h"
#include "Transforms/Splines/PowellSabinBasis.h"
#include "Transforms/Splines/TSplineBasis.h"
#include "Transforms/Splines/TensorBSplineBasis.h"
#include "Transforms/Splines/ThinPlateBasis.h"
#include "Transforms/Splines/TriangularBSplineBasis.h"

namespace crease {
namespace {

using Json = nlohmann::json;

template <int Dim>
Json point_list(const Point<Dim>& values) {
  return std::vector<double>(values.begin(), values.end());
}

template <int Dim>
Json columns(const Matrix<Dim>& direction) {
  return std::vector<double>(direction.data(), direction.data() + Dim * Dim);
}

template <int Dim>
Json tensor_to_json(const TensorBSplineBasis<Dim>& basis) {
  const auto& lattice = basis.lattice();
  return {{"kind", "tensor"},
          {"degree", basis.degree()},
          {"spans", lattice.spans},
          {"origin", point_list<Dim>(lattice.origin)},
          {"spacing", point_list<Dim>(lattice.spacing)},
          {"direction_columns", columns<Dim>(lattice.direction)}};
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> tensor_from_json(const JsonReader& reader) {
  TensorLattice<Dim> lattice;
  const JsonReader spans = reader.at("spans");
  if (spans.size() != Dim)
    reader.fail(message("the entry \"basis.spans\" needs ", Dim, " numbers"));
  double control_points = 1;
  for (int a = 0; a < Dim; ++a) {
    lattice.spans[a] = spans.at(static_cast<std::size_t>(a)).integer(1, 1 << 20);
    control_points *= lattice.spans[a];
  }
  if (control_points > 1e8) spans.fail_here("asks for too many control points");
  lattice.origin = reader.at("origin").template numbers<Dim>();
  lattice.spacing = reader.at("spacing").template numbers<Dim>();
  lattice.direction = reader.at("direction_columns").template numbers<Dim, Dim>();
  return std::make_shared<TensorBSplineBasis<Dim>>(
      lattice, reader.at("degree").integer(1, kMaxTensorDegree));
}

/// Points one after the other in one list of numbers.
template <int Dim>
Json flat(const std::vector<Point<Dim>>& points) {
  Json numbers = Json::array();
  for (const auto& p : points) {
    for (double c : p) numbers.push_back(c);
  }
  return numbers;
}

template <int Dim>
std::vector<Point<Dim>> points_of(const JsonReader& reader) {
  const auto count = reader.size() / Dim;
  const auto columns = reader.numbers<Dim, Eigen::Dynamic>(static_cast<Eigen::Index>(count));
  std::vector<Point<Dim>> points(count);
  for (std::size_t n = 0; n < count; ++n) points[n] = columns.col(n);
  return points;
}

template <int Dim>
void add_mesh(const SimplexMesh<Dim>& mesh, Json& json) {
  json["vertices"] = flat<Dim>(mesh.vertices);
  json["simplices"] = mesh.simplices;
  json["regions"] = mesh.regions;
}

Json crease_edges_to_json(const std::vector<CreaseEdge>& edges) {
  Json creases = Json::array();
  for (const auto& edge : edges) {
    creases.push_back({{"vertices", edge.vertices}, {"body_side", edge.body_side}});
  }
  return creases;
}

template <int Dim>
Json triangular_to_json(const KnotNet<Dim>& net) {
  Json clouds = Json::array();
  for (const auto& cloud : net.clouds) clouds.push_back(flat<Dim>(cloud));
  Json json = {{"kind", "triangular"},
               {"degree", net.degree},
               {"clouds", clouds},
               {"crease_edges", crease_edges_to_json(net.crease_edges)}};
  add_mesh(net.mesh, json);
  return json;
}

/// A list of as many vertex numbers as the array holds.
template <std::size_t Count>
std::array<int, Count> vertex_numbers(const JsonReader& reader, std::size_t num_vertices) {
  if (reader.size() != Count) reader.fail_here(message("does not have ", Count, " vertices"));
  std::array<int, Count> numbers;
  for (std::size_t k = 0; k < Count; ++k) {
    numbers[k] = reader.at(k).integer(0, static_cast<int>(num_vertices) - 1);
  }
  return numbers;
}

template <int Dim>
SimplexMesh<Dim> mesh_from_json(const JsonReader& reader) {
  SimplexMesh<Dim> mesh;
  mesh.vertices = points_of<Dim>(reader.at("vertices"));
  const JsonReader simplices = reader.at("simplices");
  for (std::size_t n = 0; n < simplices.size(); ++n) {
    mesh.simplices.push_back(vertex_numbers<Dim + 1>(simplices.at(n), mesh.vertices.size()));
  }
  const JsonReader regions = reader.at("regions");
  for (std::size_t n = 0; n < regions.size(); ++n) {
    mesh.regions.push_back(regions.at(n).integer(0, std::numeric_limits<int>::max()));
  }
  if (!mesh.regions.empty() && mesh.regions.size() != mesh.simplices.size()) {
    regions.fail_here("does not have one number per simplex");
  }
  return mesh;
}

std::vector<CreaseEdge> crease_edges_from_json(const JsonReader& creases,
                                               std::size_t num_vertices) {
  std::vector<CreaseEdge> edges;
  for (std::size_t n = 0; n < creases.size(); ++n) {
    const JsonReader edge = creases.at(n);
    edges.push_back(
        {vertex_numbers<2>(edge.at("vertices"), num_vertices), edge.at("body_side").flag()});
  }
  return edges;
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> triangular_from_json(const JsonReader& reader) {
  KnotNet<Dim> net;
  net.degree = reader.at("degree").integer(1, 5);
  net.mesh = mesh_from_json<Dim>(reader);
  const JsonReader clouds = reader.at("clouds");
  for (std::size_t n = 0; n < clouds.size(); ++n)
    net.clouds.push_back(points_of<Dim>(clouds.at(n)));
  net.crease_edges = crease_edges_from_json(reader.at("crease_edges"), net.mesh.vertices.size());
  return std::make_shared<TriangularBSplineBasis<Dim>>(std::move(net));
}

/// The vertices' corners are written too: control points mean nothing without them, and rules for placing
/// them may change. On a crease the normal comes first, and corners have a depth.
Json powell_sabin_to_json(const PowellSabinNet& net) {
  Json vertices = Json::array();
  for (const auto& vertex : net.vertices) {
    std::vector<double> numbers;
    if (vertex.creased()) numbers.assign(vertex.normal.begin(), vertex.normal.end());
    const Eigen::MatrixXd corners = vertex.corners.topRows(vertex.creased() ? 3 : 2);
    numbers.insert(numbers.end(), corners.reshaped().begin(), corners.reshaped().end());
    vertices.push_back(numbers);
  }
  Json json = {{"kind", "powell-sabin"},
               {"corners", vertices},
               {"crease_edges", crease_edges_to_json(net.crease_edges)}};
  add_mesh(net.mesh, json);
  return json;
}

std::shared_ptr<const SplineBasis<2>> powell_sabin_from_json(const JsonReader& reader) {
  PowellSabinNet net;
  net.mesh = mesh_from_json<2>(reader);
  const JsonReader corners = reader.at("corners");
  for (std::size_t v = 0; v < corners.size(); ++v) {
    const JsonReader numbers = corners.at(v);
    PowellSabinVertex vertex;
    vertex.corners.setZero(3, numbers.size() == 6 ? 3 : 4);
    if (numbers.size() == 6) {
      vertex.corners.topRows<2>() = numbers.numbers<2, 3>();
    } else {
      const auto all = numbers.numbers<14>();
      vertex.normal = all.head<2>();
      vertex.corners = all.tail<12>().reshaped(3, 4);
    }
    net.vertices.push_back(vertex);
  }
  net.crease_edges = crease_edges_from_json(reader.at("crease_edges"), net.mesh.vertices.size());
  return std::make_shared<PowellSabinBasis>(std::move(net));
}

std::vector<double> number_list(const JsonReader& reader) {
  const Eigen::RowVectorXd numbers =
      reader.numbers<1, Eigen::Dynamic>(static_cast<Eigen::Index>(reader.size()));
  return {numbers.begin(), numbers.end()};
}

template <int Dim>
Json nurbs_to_json(const NurbsBasis<Dim>& basis) {
  const auto& net = basis.net();
  Json knots = Json::array();
  for (const auto& axis : net.knots) knots.push_back(axis);
  Json weights = Json::array();  // none: all equal
  if (basis.is_rational()) {
    for (double w : net.weights) weights.push_back(w);
  }
  return {{"kind", "nurbs"},
          {"degree", net.degree},
          {"knots", knots},
          {"weights", weights},
          {"affine_maps", basis.reproduces_affine_maps()},
          {"origin", point_list<Dim>(net.origin)},
          {"direction_columns", columns<Dim>(net.direction)}};
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> nurbs_from_json(const JsonReader& reader) {
  NurbsNet<Dim> net;
  net.degree = reader.at("degree").integer(1, kMaxTensorDegree);
  const JsonReader knots = reader.at("knots");
  if (knots.size() != Dim) knots.fail_here(message("does not have ", Dim, " lists"));
  for (int a = 0; a < Dim; ++a) {
    net.knots[a] = number_list(knots.at(static_cast<std::size_t>(a)));
  }
  const auto weights = number_list(reader.at("weights"));
  net.weights = Eigen::Map<const Eigen::VectorXd>(weights.data(), std::ssize(weights));
  net.origin = reader.at("origin").template numbers<Dim>();
  net.direction = reader.at("direction_columns").template numbers<Dim, Dim>();
  return std::make_shared<NurbsBasis<Dim>>(std::move(net), reader.at("affine_maps").flag()
                                                               ? AffineMaps::kRequired
                                                               : AffineMaps::kNotNeeded);
}

Json tspline_to_json(const TSplineBasis& basis) {
  Json segments = Json::array();  // axis, line, begin, end
  for (const TSegment& s : basis.mesh().segments()) {
    segments.push_back({s.axis, s.line, s.begin, s.end});
  }
  return {{"kind", "tspline"},
          {"degree", basis.degree()},
          {"lines", {basis.mesh().lines(0), basis.mesh().lines(1)}},
          {"segments", segments},
          {"origin", point_list<2>(basis.box().origin)},
          {"direction_columns", columns<2>(basis.box().direction)}};
}

std::shared_ptr<const SplineBasis<2>> tspline_from_json(const JsonReader& reader) {
  const JsonReader lines = reader.at("lines"), segments = reader.at("segments");
  if (lines.size() != 2) lines.fail_here("does not have 2 lists");
  std::vector<TSegment> edges;
  constexpr int kMost = std::numeric_limits<int>::max();
  for (std::size_t n = 0; n < segments.size(); ++n) {
    const JsonReader segment = segments.at(n);
    if (segment.size() != 4) segment.fail_here("does not have 4 numbers");
    edges.push_back({segment.at(0).integer(0, 1), segment.at(1).integer(0, kMost),
                     segment.at(2).integer(0, kMost), segment.at(3).integer(0, kMost)});
  }
  TMesh mesh(reader.at("degree").integer(1, kMaxTensorDegree),
             {number_list(lines.at(0)), number_list(lines.at(1))}, edges);
  return std::make_shared<TSplineBasis>(std::move(mesh), reader.at("origin").numbers<2>(),
                                        reader.at("direction_columns").numbers<2, 2>());
}

template <int Dim>
Json thin_plate_to_json(const ThinPlateBasis<Dim>& basis) {
  const ControlPoints<Dim>& centres = basis.centres();
  return {{"kind", "thin-plate"},
          {"centres", std::vector<double>(centres.data(), centres.data() + centres.size())},
          {"lower", point_list<Dim>(basis.bounds().lower)},
          {"upper", point_list<Dim>(basis.bounds().upper)}};
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> thin_plate_from_json(const JsonReader& reader) {
  const JsonReader centres = reader.at("centres");
  const auto count = static_cast<Eigen::Index>(centres.size() / Dim);
  Box<Dim> bounds;
  bounds.lower = reader.at("lower").template numbers<Dim>();
  bounds.upper = reader.at("upper").template numbers<Dim>();
  return std::make_shared<ThinPlateBasis<Dim>>(centres.numbers<Dim, Eigen::Dynamic>(count), bounds);
}

}  // namespace

template <int Dim>
nlohmann::json basis_to_json(const SplineBasis<Dim>& basis) {
  if (const auto* tensor = dynamic_cast<const TensorBSplineBasis<Dim>*>(&basis)) {
    return tensor_to_json(*tensor);
  }
  if (const auto* triangular = dynamic_cast<const TriangularBSplineBasis<Dim>*>(&basis)) {
    return triangular_to_json(triangular->net());
  }
  if (const auto* thin_plate = dynamic_cast<const ThinPlateBasis<Dim>*>(&basis)) {
    return thin_plate_to_json(*thin_plate);
  }
  if (const auto* nurbs = dynamic_cast<const NurbsBasis<Dim>*>(&basis)) {
    return nurbs_to_json(*nurbs);
  }
  if constexpr (Dim == 2) {
    if (const auto* powell_sabin = dynamic_cast<const PowellSabinBasis*>(&basis)) {
      return powell_sabin_to_json(powell_sabin->net());
    }
    if (const auto* tspline = dynamic_cast<const TSplineBasis*>(&basis)) {
      return tspline_to_json(*tspline);
    }
  }
  throw InvalidInput("save_transform: splines of this kind cannot be written to a file.");
}

template <int Dim>
std::shared_ptr<const SplineBasis<Dim>> basis_from_json(const JsonReader& reader) {
  const std::string kind = reader.at("kind").text();
  if (kind == "tensor") return tensor_from_json<Dim>(reader);
  if (kind == "triangular") return triangular_from_json<Dim>(reader);
  if (kind == "thin-plate") return thin_plate_from_json<Dim>(reader);
  if (kind == "nurbs") return nurbs_from_json<Dim>(reader);
  if constexpr (Dim == 2) {
    if (kind == "powell-sabin") return powell_sabin_from_json(reader);
    if (kind == "tspline") return tspline_from_json(reader);
  }
  reader.fail(message("the spline kind \"", kind, "\" is unknown"));
}

#define CREASE_INSTANTIATE(Dim)                                   \
  template nlohmann::json basis_to_json(const SplineBasis<Dim>&); \
  template std::shared_ptr<const SplineBasis<Dim>> basis_from_json<Dim>(const JsonReader&);
CREASE_INSTANTIATE(2)
CREASE_INSTANTIATE(3)
#undef CREASE_INSTANTIATE

}  // namespace crease
