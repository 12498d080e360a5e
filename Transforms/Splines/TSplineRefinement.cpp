#include "Transforms/Splines/TSplineRefinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "Core/Error.h"
#include "Transforms/Splines/TMeshNesting.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

constexpr std::size_t kMostFaces = 2'000'000;

/// A face to be halved along some axes: along u by an edge that runs along v.
struct Halving {
  TFace face;
  std::array<bool, 2> along;
};

double middle(const TMesh& mesh, const TFace& face, int axis) {
  return 0.5 * (mesh.knot(axis, face.lower[axis]) + mesh.knot(axis, face.upper[axis]));
}

/// The mesh with the edges, not yet analysis-suitable.
TMesh halved(const TMesh& mesh, const std::vector<Halving>& halvings) {
  std::array<std::vector<double>, 2> knots;
  for (const auto& [face, along] : halvings) {
    for (int a : {0, 1}) {
      if (along[a]) knots[a].push_back(middle(mesh, face, a));
    }
  }
  TMesh result = mesh.with_knots(knots);
  for (const auto& [face, along] : halvings) {
    const auto line = [&](int axis, int number) {
      // Faces between repeated lines have size: of equal lines the inner ones bound them.
      const double knot = mesh.knot(axis, number);
      int found = result.find_line(axis, knot), copies = 0;
      while (number - copies > 0 && mesh.knot(axis, number - copies - 1) == knot) ++copies;
      return found + copies;
    };
    for (int a : {0, 1}) {
      if (!along[a]) continue;
      result.add({1 - a, result.find_line(a, middle(mesh, face, a)), line(1 - a, face.lower[1 - a]),
                  line(1 - a, face.upper[1 - a])});
    }
  }
  return result;
}

void check_control_points(const TSplineBasis& basis, Eigen::Index columns, const char* who) {
  if (columns != basis.num_control_points()) {
    throw InvalidInput(message(who, ": ", columns, " control points given, ",
                               basis.num_control_points(), " expected."));
  }
}

TSplineRefinement refined_to(const TSplineBasis& basis,
                             const Eigen::Ref<const Eigen::MatrixXd>& control_points, TMesh finer) {
  TNesting nesting = nested(basis.mesh(), std::move(finer));
  return {basis.on(std::move(nesting.mesh)), control_points * nesting.transfer};
}

/// For every cell between lines (u fastest) the number of the face that holds it.
std::vector<int> face_of_cells(const TMesh& mesh, const std::vector<TFace>& faces) {
  const int cells_u = mesh.num_lines(0) - 1;
  std::vector<int> owner(static_cast<std::size_t>(cells_u) * (mesh.num_lines(1) - 1));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int j = faces[f].lower[1]; j < faces[f].upper[1]; ++j) {
      for (int i = faces[f].lower[0]; i < faces[f].upper[0]; ++i) {
        owner[j * cells_u + i] = static_cast<int>(f);
      }
    }
  }
  return owner;
}

/// What the pixels of a raster ask for, face by face.
class AskedLengths {
 public:
  AskedLengths(const Raster<2>& raster, const EdgeLengthField& field) : raster_(raster) {
    for (int j = 0; j < raster.size[1]; ++j) {
      for (int i = 0; i < raster.size[0]; ++i) {
        const Point<2> x = raster.point({double(i), double(j)});
        asked_.push_back(field(x));
        if (!(asked_.back() > 0)) {
          throw InvalidInput(message("covering_tspline: at (", x.transpose(),
                                     ") mm the edge length "
                                     "asked for is ",
                                     asked_.back(), "; it must be positive."));
        }
      }
    }
  }

  std::vector<double> least(const TMesh& mesh, const std::vector<TFace>& faces) const {
    std::vector<double> least(faces.size(), std::numeric_limits<double>::infinity());
    const auto owner = face_of_cells(mesh, faces);
    std::array<std::vector<int>, 2> cell;  // of every column and row of pixels
    for (int a : {0, 1}) {
      const auto& lines = mesh.lines(a);
      for (int i = 0; i < raster_.size[a]; ++i) {
        const auto above =
            std::upper_bound(lines.begin(), lines.end(), (i + 0.5) * raster_.spacing[a]);
        cell[a].push_back(static_cast<int>(above - lines.begin()) - 1);
      }
    }
    for (std::size_t n = 0; n < asked_.size(); ++n) {
      const std::size_t i = n % raster_.size[0], j = n / raster_.size[0];
      double& of_face = least[owner[cell[1][j] * (mesh.num_lines(0) - 1) + cell[0][i]]];
      of_face = std::min(of_face, asked_[n]);
    }
    return least;
  }

 private:
  const Raster<2>& raster_;
  std::vector<double> asked_;  // per pixel
};

}  // namespace

TSplineRefinement refined(const TSplineBasis& basis,
                          const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                          const std::vector<int>& elements) {
  check_control_points(basis, control_points.cols(), "refined");
  const TMesh& mesh = basis.mesh();
  const auto faces = mesh.faces();
  const auto owner = face_of_cells(mesh, faces);
  std::vector<std::uint8_t> taken(faces.size(), 0);
  std::vector<Halving> halvings;
  for (int e : elements) {
    if (e < 0 || e >= std::ssize(basis.elements())) {
      throw InvalidInput(message("refined: there is no Bezier element ", e, "; the basis has ",
                                 basis.elements().size(), "."));
    }
    const TPoint cell = basis.elements()[e].face.lower;
    const int face = owner[cell[1] * (mesh.num_lines(0) - 1) + cell[0]];
    if (taken[face]) continue;
    taken[face] = 1;
    halvings.push_back({faces[face], {true, true}});
  }
  return refined_to(basis, control_points, halved(mesh, halvings));
}

TSplineRefinement refined_around(const TSplineBasis& basis,
                                 const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                                 const std::vector<int>& control_point_numbers) {
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(basis.num_control_points()), 0);
  for (int i : control_point_numbers) {
    if (i < 0 || i >= basis.num_control_points()) {
      throw InvalidInput(message("refined_around: there is no control point ", i,
                                 "; the basis has ", basis.num_control_points(), "."));
    }
    wanted[i] = 1;
  }
  std::vector<int> elements;
  for (int e = 0; e < std::ssize(basis.elements()); ++e) {
    const auto& functions = basis.elements()[e].functions;
    if (std::any_of(functions.begin(), functions.end(), [&](int i) { return wanted[i] != 0; })) {
      elements.push_back(e);
    }
  }
  return refined(basis, control_points, elements);
}

TSplineRefinement with_edges(const TSplineBasis& basis,
                             const Eigen::Ref<const Eigen::MatrixXd>& control_points,
                             const std::vector<TEdge>& edges) {
  check_control_points(basis, control_points.cols(), "with_edges");
  std::array<std::vector<double>, 2> knots;
  for (const TEdge& e : edges) {
    const auto inside = [&](int axis, double knot) {
      return knot >= basis.box().lower[axis] && knot <= basis.box().upper[axis];
    };
    if (e.axis < 0 || e.axis > 1 || !(e.begin < e.end) || !inside(1 - e.axis, e.knot) ||
        !inside(e.axis, e.begin) || !inside(e.axis, e.end)) {
      throw InvalidInput(message("with_edges: the edge along axis ", e.axis, " at ", e.knot,
                                 " from ", e.begin, " to ", e.end, " does not lie in the domain."));
    }
    knots[1 - e.axis].push_back(e.knot);
    knots[e.axis].insert(knots[e.axis].end(), {e.begin, e.end});
  }
  TMesh finer = basis.mesh().with_knots(knots);
  for (const TEdge& e : edges) {
    finer.add({e.axis, finer.find_line(1 - e.axis, e.knot), finer.find_line(e.axis, e.begin),
               finer.find_line(e.axis, e.end)});
  }
  finer = rectangular(std::move(finer)).without_empty_lines();
  finer.check();
  return refined_to(basis, control_points, std::move(finer));
}

std::shared_ptr<const TSplineBasis> covering_tspline(const Raster<2>& raster, double length_mm,
                                                     const EdgeLengthField& finer_at, int degree) {
  const TensorLattice<2> lattice = covering_lattice(raster, length_mm);
  std::array<KnotVector, 2> knots;
  for (int a : {0, 1}) {
    knots[a] =
        KnotVector::even(degree, 0.0, lattice.spans[a] * lattice.spacing[a], lattice.spans[a]);
  }
  TMesh mesh = TMesh::tensor(knots[0], knots[1]);
  if (finer_at) {
    const AskedLengths asked(raster, finer_at);
    while (true) {
      const auto faces = mesh.faces();
      if (faces.size() > kMostFaces) {
        throw InvalidInput(message("covering_tspline: the edge lengths asked for make more than ",
                                   kMostFaces, " faces; ask for larger ones."));
      }
      const auto least = asked.least(mesh, faces);
      std::vector<Halving> halvings;
      for (std::size_t f = 0; f < faces.size(); ++f) {
        std::array<bool, 2> along;
        for (int a : {0, 1}) {
          const double length = mesh.knot(a, faces[f].upper[a]) - mesh.knot(a, faces[f].lower[a]);
          along[a] = length > std::numbers::sqrt2 * least[f];
        }
        if (along[0] || along[1]) halvings.push_back({faces[f], along});
      }
      if (halvings.empty()) break;
      mesh = halved(mesh, halvings);
    }
    mesh = analysis_suitable(std::move(mesh));
  }
  return std::make_shared<TSplineBasis>(std::move(mesh), lattice.origin, lattice.direction);
}

}  // namespace crease
