// itk_write_transforms FOLDER: transforms of each class that crease reads, written by ITK itself, and where
// ITK maps points by them. FOLDER gets NAME.tfm, NAME.h5 and, of single transforms, NAME.mat; fields as images,
// too; and NAME.points, "x y[ z] x' y'[ z']" per line in mm. NAME begins with the dimension. Links ITK alone.
#include <hdf5.h>
#include <itkAffineTransform.h>
#include <itkBSplineDeformableTransform.h>
#include <itkBSplineTransform.h>
#include <itkCenteredAffineTransform.h>
#include <itkCenteredEuler3DTransform.h>
#include <itkCenteredRigid2DTransform.h>
#include <itkCenteredSimilarity2DTransform.h>
#include <itkComposeScaleSkewVersor3DTransform.h>
#include <itkCompositeTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkEuler2DTransform.h>
#include <itkEuler3DTransform.h>
#include <itkFixedCenterOfRotationAffineTransform.h>
#include <itkHDF5TransformIO.h>
#include <itkIdentityTransform.h>
#include <itkImageFileWriter.h>
#include <itkMatlabTransformIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkQuaternionRigidTransform.h>
#include <itkRigid2DTransform.h>
#include <itkRigid3DTransform.h>
#include <itkScalableAffineTransform.h>
#include <itkScaleLogarithmicTransform.h>
#include <itkScaleSkewVersor3DTransform.h>
#include <itkScaleVersor3DTransform.h>
#include <itkSimilarity2DTransform.h>
#include <itkSimilarity3DTransform.h>
#include <itkThinPlateSplineKernelTransform.h>
#include <itkTransformFactory.h>
#include <itkTransformFileReader.h>
#include <itkTransformFileWriter.h>
#include <itkTranslationTransform.h>
#include <itkTxtTransformIO.h>
#include <itkVersorRigid3DTransform.h>
#include <itkVersorTransform.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <random>
#include <string>

namespace {

template <typename Number>
using Writer = itk::TransformFileWriterTemplate<Number>;

std::string folder;
std::mt19937 engine(7);

double random_number(double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(engine);
}

std::string path(unsigned dimension, const std::string& name, const std::string& ending) {
  return folder + "/" + std::to_string(dimension) + "-" + name + ending;
}

template <typename IO, typename Number>
void write(const itk::TransformBaseTemplate<Number>* transform, const std::string& file) {
  const auto writer = Writer<Number>::New();
  writer->SetTransformIO(IO::New());
  writer->SetInput(transform);
  writer->SetFileName(file);
  writer->Update();
}

/// Points of a box, and where they go.
template <unsigned Dim>
void write_points(const itk::Transform<double, Dim, Dim>* transform, const std::string& name,
                  double from = -30, double to = 60) {
  std::ofstream stream(path(Dim, name, ".points"));
  stream.precision(std::numeric_limits<double>::max_digits10);
  for (int k = 0; k < 300; ++k) {
    itk::Point<double, Dim> x;
    for (unsigned a = 0; a < Dim; ++a) x[a] = random_number(from, to);
    const auto y = transform->TransformPoint(x);
    for (unsigned a = 0; a < Dim; ++a) stream << x[a] << ' ';
    for (unsigned a = 0; a < Dim; ++a) stream << y[a] << ' ';
    stream << '\n';
  }
}

template <unsigned Dim>
void write_files(const itk::Transform<double, Dim, Dim>* transform, const std::string& name) {
  write<itk::TxtTransformIOTemplate<double>, double>(transform, path(Dim, name, ".tfm"));
  write<itk::HDF5TransformIOTemplate<double>, double>(transform, path(Dim, name, ".h5"));
  if (transform->GetTransformCategory() ==
      itk::TransformBaseTemplate<double>::TransformCategoryEnum::Linear) {
    write<itk::MatlabTransformIOTemplate<double>, double>(transform, path(Dim, name, ".mat"));
  }
}

template <unsigned Dim>
void write_all(const itk::Transform<double, Dim, Dim>* transform, const std::string& name,
               double from = -30, double to = 60) {
  write_files<Dim>(transform, name);
  write_points<Dim>(transform, name, from, to);
}

/// Away from the identity: small changes of all parameters but larger ones of the translation.
template <typename Kind>
typename Kind::Pointer changed() {
  const auto transform = Kind::New();
  auto fixed = transform->GetFixedParameters();
  for (unsigned k = 0; k < fixed.size() && k < Kind::InputSpaceDimension; ++k)
    fixed[k] = 5.5 + 3 * k;
  if (!fixed.empty()) transform->SetFixedParameters(fixed);
  auto parameters = transform->GetParameters();
  for (unsigned k = 0; k < parameters.size(); ++k) parameters[k] += random_number(-0.2, 0.3);
  if (!parameters.empty()) transform->SetParameters(parameters);
  return transform;
}

template <typename Kind>
void write_changed(const std::string& name) {
  write_all<Kind::InputSpaceDimension>(changed<Kind>(), name);
}

/// A direction that is no identity: a turn in the first plane, 3D also one in the last.
template <unsigned Dim>
itk::Matrix<double, Dim, Dim> turned() {
  itk::Matrix<double, Dim, Dim> first, last;
  first.SetIdentity();
  last.SetIdentity();
  const double c = std::cos(0.3), s = std::sin(0.3);
  first(0, 0) = first(1, 1) = c;
  first(0, 1) = -s;
  first(1, 0) = s;
  if (Dim == 3) {
    last(1, 1) = last(2, 2) = c;
    last(1, 2) = -s;
    last(2, 1) = s;
  }
  return first * last;
}

template <typename Kind>
void set_random_parameters(Kind* transform, double size) {
  auto parameters = transform->GetParameters();
  for (auto& p : parameters) p = random_number(-size, size);
  transform->SetParametersByValue(parameters);
}

/// Its domain holds the box [-10, 20]^Dim.
template <typename Number, unsigned Dim, unsigned Order>
typename itk::BSplineTransform<Number, Dim, Order>::Pointer spline() {
  using Kind = itk::BSplineTransform<Number, Dim, Order>;
  const auto transform = Kind::New();
  typename Kind::OriginType origin;
  typename Kind::PhysicalDimensionsType size;
  typename Kind::MeshSizeType mesh;
  for (unsigned a = 0; a < Dim; ++a) {
    origin[a] = a == 0 ? -10 : -35;
    size[a] = 90 + 7 * a;
    mesh[a] = 5 - a;
  }
  if (Dim == 3) origin[0] = -20;
  transform->SetTransformDomainOrigin(origin);
  transform->SetTransformDomainPhysicalDimensions(size);
  transform->SetTransformDomainMeshSize(mesh);
  transform->SetTransformDomainDirection(turned<Dim>());
  set_random_parameters(transform.GetPointer(), 4);
  return transform;
}

/// The same domain in the class of ITK 3.
template <unsigned Dim>
void write_old_spline() {
  using Kind = itk::BSplineDeformableTransform<double, Dim, 3>;
  const auto transform = Kind::New();
  transform->SetFixedParameters(spline<double, Dim, 3>()->GetFixedParameters());
  set_random_parameters(transform.GetPointer(), 4);
  write_all<Dim>(transform, "spline-deformable", 0, 15);
}

template <typename Number, unsigned Dim>
typename itk::DisplacementFieldTransform<Number, Dim>::Pointer field() {
  using Kind = itk::DisplacementFieldTransform<Number, Dim>;
  const auto image = Kind::DisplacementFieldType::New();
  typename Kind::DisplacementFieldType::SizeType size;
  typename Kind::DisplacementFieldType::PointType origin;
  typename Kind::DisplacementFieldType::SpacingType spacing;
  for (unsigned a = 0; a < Dim; ++a) {
    size[a] = 12 - 2 * a;
    origin[a] = a - 8.0;
    spacing[a] = 2.5 + 0.7 * a;
  }
  image->SetRegions(size);
  image->SetOrigin(origin);
  image->SetSpacing(spacing);
  image->SetDirection(turned<Dim>());
  image->Allocate();
  for (std::size_t k = 0; k < image->GetPixelContainer()->Size(); ++k) {
    for (unsigned a = 0; a < Dim; ++a) {
      image->GetBufferPointer()[k][a] = static_cast<Number>(random_number(-3, 3));
    }
  }
  const auto transform = Kind::New();
  transform->SetDisplacementField(image);
  return transform;
}

template <unsigned Dim, typename IO, typename Field>
void write_field_image(const Field* image, const std::string& ending) {
  const auto writer = itk::ImageFileWriter<Field>::New();
  writer->SetImageIO(IO::New());
  writer->SetInput(image);
  writer->SetFileName(path(Dim, "field", ending));
  writer->Update();
}

template <unsigned Dim>
void write_field() {
  const auto transform = field<double, Dim>();
  write_all<Dim>(transform, "field");
  const auto* image = transform->GetDisplacementField();
  write_field_image<Dim, itk::MetaImageIO>(image, ".mha");
  write_field_image<Dim, itk::NrrdImageIO>(image, ".nrrd");
  write_field_image<Dim, itk::NiftiImageIO>(image, ".nii.gz");
}

template <typename Number, unsigned Dim, typename Affine>
typename itk::CompositeTransform<Number, Dim>::Pointer composite(Affine* affine) {
  const auto chain = itk::CompositeTransform<Number, Dim>::New();
  const auto shift = itk::TranslationTransform<Number, Dim>::New();
  auto offset = shift->GetParameters();
  for (unsigned a = 0; a < Dim; ++a) offset[a] = a == 0 ? 2 : -1;
  shift->SetParameters(offset);
  chain->AddTransform(affine);
  chain->AddTransform(spline<Number, Dim, 3>());
  chain->AddTransform(field<Number, Dim>());
  chain->AddTransform(shift);
  return chain;
}

/// Single precision in the file; the points are those of ITK when it reads that in double precision.
template <typename FloatIO, typename DoubleIO, unsigned Dim>
void write_single_precision(const itk::CompositeTransform<float, Dim>* chain,
                            const std::string& name, const std::string& ending) {
  write<FloatIO, float>(chain, path(Dim, name, ending));
  const auto reader = itk::TransformFileReaderTemplate<double>::New();
  reader->SetTransformIO(DoubleIO::New());
  reader->SetFileName(path(Dim, name, ending));
  reader->Update();
  const auto* read = dynamic_cast<itk::Transform<double, Dim, Dim>*>(
      reader->GetTransformList()->front().GetPointer());
  write_points<Dim>(read, name, 0, 12);
}

template <unsigned Dim>
void write_single_precision() {
  const auto chain =
      composite<float, Dim>(changed<itk::AffineTransform<float, Dim>>().GetPointer());
  write_single_precision<itk::TxtTransformIOTemplate<float>, itk::TxtTransformIOTemplate<double>,
                         Dim>(chain, "float-text", ".tfm");
  write_single_precision<itk::HDF5TransformIOTemplate<float>, itk::HDF5TransformIOTemplate<double>,
                         Dim>(chain, "float-hdf5", ".h5");
}

/// Before version 5 ITK misspelled the names of the lists in HDF5 files.
template <unsigned Dim>
void write_old_names() {
  const auto transform = changed<itk::AffineTransform<double, Dim>>();
  const std::string name = path(Dim, "old-names", ".h5");
  write<itk::HDF5TransformIOTemplate<double>, double>(transform.GetPointer(), name);
  write_points<Dim>(transform, "old-names");
  const hid_t file = H5Fopen(name.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  for (const std::string list : {"FixedParameters", "Parameters"}) {
    const std::string group = "/TransformGroup/0/";
    if (H5Lmove(file, (group + "Transform" + list).c_str(), file,
                (group + "Tranform" + list).c_str(), H5P_DEFAULT, H5P_DEFAULT) < 0) {
      throw std::runtime_error(name + ": no list to give its old name");
    }
  }
  H5Fclose(file);
}

/// What crease has no equal of.
template <unsigned Dim>
void write_kernel_spline() {
  using Kind = itk::ThinPlateSplineKernelTransform<double, Dim>;
  const auto landmarks = Kind::PointSetType::New();
  for (unsigned k = 0; k < 6; ++k) {
    typename Kind::InputPointType x;
    for (unsigned a = 0; a < Dim; ++a) x[a] = random_number(0, 10);
    landmarks->SetPoint(k, x);
  }
  const auto transform = Kind::New();
  transform->SetSourceLandmarks(landmarks);
  transform->SetTargetLandmarks(landmarks);
  transform->ComputeWMatrix();
  write<itk::TxtTransformIOTemplate<double>, double>(transform.GetPointer(),
                                                     path(Dim, "kernel", ".tfm"));
}

template <unsigned Dim>
void write_common() {
  write_all<Dim>(itk::IdentityTransform<double, Dim>::New(), "identity");
  write_changed<itk::TranslationTransform<double, Dim>>("translation");
  write_changed<itk::ScaleTransform<double, Dim>>("scale");
  write_changed<itk::ScaleLogarithmicTransform<double, Dim>>("scale-logarithmic");
  write_changed<itk::AffineTransform<double, Dim>>("affine");
  write_changed<itk::MatrixOffsetTransformBase<double, Dim, Dim>>("matrix-offset");
  write_changed<itk::FixedCenterOfRotationAffineTransform<double, Dim>>("fixed-centre");
  write_changed<itk::ScalableAffineTransform<double, Dim>>("scalable");
  write_changed<itk::CenteredAffineTransform<double, Dim>>("centred-affine");
  write_all<Dim>(spline<double, Dim, 1>(), "spline-1", 0, 15);
  write_all<Dim>(spline<double, Dim, 2>(), "spline-2", 0, 15);
  write_all<Dim>(spline<double, Dim, 3>(), "spline-3", 0, 15);
  write_old_spline<Dim>();
  write_field<Dim>();
  write_single_precision<Dim>();
  write_old_names<Dim>();
  write_kernel_spline<Dim>();
}

void write_plane() {
  write_common<2>();
  write_changed<itk::Euler2DTransform<double>>("euler");
  write_changed<itk::Rigid2DTransform<double>>("rigid");
  write_changed<itk::CenteredRigid2DTransform<double>>("centred-rigid");
  write_changed<itk::Similarity2DTransform<double>>("similarity");
  write_changed<itk::CenteredSimilarity2DTransform<double>>("centred-similarity");
  const auto affine = changed<itk::Euler2DTransform<double>>();
  write_all<2>(composite<double, 2>(affine.GetPointer()), "composite", 0, 12);
}

void write_space() {
  write_common<3>();
  write_changed<itk::Euler3DTransform<double>>("euler");
  const auto zyx = changed<itk::Euler3DTransform<double>>();
  zyx->SetComputeZYX(true);
  write_all<3>(zyx, "euler-zyx");
  const auto centred = changed<itk::CenteredEuler3DTransform<double>>();
  write_all<3>(centred, "centred-euler");
  write_changed<itk::VersorTransform<double>>("versor");
  write_changed<itk::VersorRigid3DTransform<double>>("versor-rigid");
  const auto half_turn = itk::VersorRigid3DTransform<double>::New();
  auto parameters = half_turn->GetParameters();
  const double almost[] = {0.6, -0.64, 0.48 * (1 - 1e-9), 7, -2, 30};
  for (unsigned k = 0; k < 6; ++k) parameters[k] = almost[k];
  half_turn->SetParameters(parameters);
  write_all<3>(half_turn, "versor-half-turn");
  write_changed<itk::QuaternionRigidTransform<double>>("quaternion");
  const auto rigid = itk::Rigid3DTransform<double>::New();
  rigid->SetMatrix(turned<3>());
  itk::Vector<double, 3> shift;
  shift.Fill(4.5);
  rigid->Translate(shift);
  write_all<3>(rigid, "rigid");
  write_changed<itk::Similarity3DTransform<double>>("similarity");
  write_changed<itk::ScaleVersor3DTransform<double>>("scale-versor");
  write_changed<itk::ScaleSkewVersor3DTransform<double>>("scale-skew-versor");
  write_changed<itk::ComposeScaleSkewVersor3DTransform<double>>("compose-scale-skew-versor");
  const auto euler = changed<itk::Euler3DTransform<double>>();
  write_all<3>(composite<double, 3>(euler.GetPointer()), "composite", 0, 12);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: itk_write_transforms FOLDER\n";
    return 2;
  }
  folder = argv[1];
  try {
    itk::TransformFactoryBase::RegisterDefaultTransforms();
    write_plane();
    write_space();
  } catch (const std::exception& error) {
    std::cerr << "itk_write_transforms: " << error.what() << '\n';
    return 1;
  }
}
