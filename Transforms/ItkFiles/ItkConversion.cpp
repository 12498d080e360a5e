#include "Transforms/ItkFiles/ItkConversion.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <span>

#include "Core/Error.h"
#include "Transforms/CompositeTransform.h"
#include "Transforms/DisplacementFieldTransform.h"
#include "Transforms/ItkFiles/ItkLinear.h"
#include "Transforms/SplineTransform.h"
#include "Transforms/Splines/TensorBSplineBasis.h"

namespace crease {
namespace {

constexpr std::string_view kComposite = "CompositeTransform";

/// "BSplineTransform_double_2_2_1", taken apart.
struct ClassName {
  std::string name;   // "BSplineTransform"
  int dimension = 0;  // 0: not the same in and out, or no number
  int order = 3;      // of B-splines; ITK tells it where it is not 3
};

int number(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : 0;
}

ClassName parse(const std::string& name) {
  std::vector<std::string_view> words;
  for (std::string_view rest = name;;) {
    const std::size_t end = rest.find('_');
    words.push_back(rest.substr(0, end));
    if (end == std::string_view::npos) break;
    rest.remove_prefix(end + 1);
  }
  ClassName result{std::string(words[0])};
  const bool typed = words.size() > 3 && (words[1] == "double" || words[1] == "float");
  if (typed && words[2] == words[3]) result.dimension = number(words[2]);
  if (words.size() > 4) result.order = number(words[4]);
  return result;
}

bool is_spline(const std::string& name) {
  return name == "BSplineTransform" || name == "BSplineDeformableTransform";
}

/// These smooth their field while it is optimised; as maps they are all the same.
bool is_field(const std::string& name) {
  return name == "DisplacementFieldTransform" ||
         name == "GaussianSmoothingOnUpdateDisplacementFieldTransform" ||
         name == "BSplineSmoothingOnUpdateDisplacementFieldTransform";
}

/// "FILE: transform 2 (ScaleTransform_double_2_2): what."
[[noreturn]] void fail(const ItkTransformList& list, std::size_t k, const std::string& what) {
  const std::string place = list.transforms.size() > 1 ? message("transform ", k, " (") : "the ";
  throw FileError(message(list.file.string(), ": ", place, list.transforms[k].name,
                          list.transforms.size() > 1 ? ") " : " ", what, "."));
}

template <int Dim>
std::string type_of(const std::string& name) {
  if (is_itk_rigid<Dim>(name)) return "rigid";
  if (is_itk_linear<Dim>(name)) return "affine";
  if (is_spline(name)) return "spline";
  if (is_field(name)) return "displacement field";
  return {};
}

/// @throws FileError when the class is unknown or of another dimension than the file's first one.
std::string checked_type(const ItkTransformList& list, std::size_t k, int dimension) {
  const ClassName own = parse(list.transforms[k].name);
  if (own.dimension != dimension) {
    fail(list, k, message("does not map from ", dimension, "D to ", dimension, "D"));
  }
  const std::string type = dimension == 2 ? type_of<2>(own.name) : type_of<3>(own.name);
  if (!type.empty()) return type;
  if (own.name == kComposite) {
    fail(list, k,
         "stands within a list, where it would be empty: ITK knows one composite per file, at its "
         "beginning");
  }
  fail(list, k,
       "is of a class that crease has no equal of; let ITK sample it as a displacement field "
       "(TransformToDisplacementField), and take that image");
}

/// A raster from ITK's [size, origin, spacing, direction by rows]; files before ITK 4 lack the direction.
template <int Dim>
Raster<Dim> raster_of(const Eigen::VectorXd& fixed) {
  if (fixed.size() != Dim * (3 + Dim) && fixed.size() != 3 * Dim) {
    throw InvalidInput(
        message("has ", fixed.size(), " fixed parameters instead of ", Dim * (3 + Dim)));
  }
  if (!fixed.allFinite()) throw InvalidInput("has a fixed parameter that is not finite");
  Raster<Dim> raster;
  for (int a = 0; a < Dim; ++a) {
    if (!(fixed[a] >= 1 && fixed[a] < 1e9) || fixed[a] != std::floor(fixed[a])) {
      throw InvalidInput(message("has a grid of ", fixed[a], " samples along axis ", a + 1));
    }
    raster.size[a] = static_cast<int>(fixed[a]);
  }
  raster.origin = fixed.template segment<Dim>(Dim);
  raster.spacing = fixed.template segment<Dim>(2 * Dim);
  if (fixed.size() > 3 * Dim) {
    raster.direction = fixed.tail(Dim * Dim).reshaped(Dim, Dim).transpose();
  }
  return raster;
}

/// @throws InvalidInput unless there are Dim numbers for every sample, all of them finite.
template <int Dim>
void check_count(const Raster<Dim>& raster, const Eigen::VectorXd& parameters) {
  double wanted = Dim;
  for (int size : raster.size) wanted *= size;
  if (static_cast<double>(parameters.size()) != wanted) {
    throw InvalidInput(message("has ", parameters.size(), " parameters instead of ", wanted));
  }
  for (Eigen::Index n = 0; n < parameters.size(); ++n) {
    if (!std::isfinite(parameters[n])) {
      throw InvalidInput(
          message("has ", parameters[n], " as parameter ", n, "; all must be finite"));
    }
  }
}

template <int Dim>
std::unique_ptr<Transform<Dim>> spline_from_itk(const ItkTransform& transform, int degree) {
  if (degree < 1 || degree > 3) throw InvalidInput("is a B-spline of another order than 1, 2 or 3");
  const Raster<Dim> net = raster_of<Dim>(transform.fixed_parameters);
  check_count(net, transform.parameters);
  if (!(net.direction.transpose() * net.direction).isApprox(Matrix<Dim>::Identity(), 1e-6)) {
    throw InvalidInput("lies on a sheared grid, which crease's splines cannot");
  }
  TensorLattice<Dim> lattice;
  lattice.spacing = net.spacing;
  lattice.direction = net.direction;
  lattice.origin = net.point(Vector<Dim>::Constant(0.5 * (degree - 1)));
  for (int a = 0; a < Dim; ++a) {
    lattice.spans[a] = net.size[a] - degree;
    if (lattice.spans[a] < 1) {
      throw InvalidInput(message("has a grid of ", net.size[a], " samples along axis ", a + 1,
                                 "; one of order ", degree, " needs more than ", degree));
    }
  }
  auto spline = std::make_unique<SplineTransform<Dim>>(
      std::make_shared<TensorBSplineBasis<Dim>>(lattice, degree));
  // All of one coordinate come first.
  spline->set_control_points(
      transform.parameters.reshaped(net.num_samples(), Dim).transpose().eval());
  return spline;
}

template <int Dim>
std::unique_ptr<Transform<Dim>> field_from_itk(const ItkTransform& transform) {
  const Raster<Dim> raster = raster_of<Dim>(transform.fixed_parameters);
  check_count(raster, transform.parameters);
  return std::make_unique<DisplacementFieldTransform<Dim>>(
      raster, transform.parameters.reshaped(Dim, raster.num_samples()));
}

template <int Dim>
std::unique_ptr<Transform<Dim>> convert(const ItkTransformList& list, std::size_t k) {
  const ItkTransform& transform = list.transforms[k];
  const ClassName own = parse(transform.name);
  try {
    if (is_itk_linear<Dim>(own.name)) return itk_linear<Dim>(own.name, transform);
    if (is_spline(own.name)) return spline_from_itk<Dim>(transform, own.order);
    return field_from_itk<Dim>(transform);
  } catch (const InvalidInput& error) {
    fail(list, k, error.what());
  }
}

}  // namespace

ItkSummary summary_of(const ItkTransformList& list) {
  const ClassName first = parse(list.transforms.at(0).name);
  if (first.dimension != 2 && first.dimension != 3) {
    fail(list, 0, "maps neither from 2D to 2D nor from 3D to 3D");
  }
  if (first.name == kComposite) {
    for (std::size_t k = 1; k < list.transforms.size(); ++k) {
      checked_type(list, k, first.dimension);
    }
    return {"composite", first.dimension};
  }
  if (list.transforms.size() > 1) {
    throw FileError(
        message(list.file.string(), ": holds ", list.transforms.size(),
                " transforms that are no composite, so that their order is not told; save each "
                "in a file of its own and give them as a chain."));
  }
  return {checked_type(list, 0, first.dimension), first.dimension};
}

template <int Dim>
std::unique_ptr<Transform<Dim>> from_itk(const ItkTransformList& list) {
  const ItkSummary summary = summary_of(list);
  if (summary.dimension != Dim) {
    throw FileError(message(list.file.string(), ": holds a transform from ", summary.dimension,
                            "D to ", summary.dimension, "D; one from ", Dim, "D to ", Dim,
                            "D is needed."));
  }
  if (summary.type != "composite") return convert<Dim>(list, 0);
  std::vector<std::unique_ptr<Transform<Dim>>> parts;
  for (std::size_t k = list.transforms.size(); k-- > 1;) parts.push_back(convert<Dim>(list, k));
  return std::make_unique<CompositeTransform<Dim>>(std::move(parts));
}

template std::unique_ptr<Transform<2>> from_itk<2>(const ItkTransformList&);
template std::unique_ptr<Transform<3>> from_itk<3>(const ItkTransformList&);

}  // namespace crease
