// itk_map_points DIM FILE IN OUT: maps points as any ITK program would. FILE is a transform (.tfm) or a
// displacement field (.mha); IN and OUT hold one point per line, DIM numbers in mm. Links ITK alone.
#include <itkBSplineTransform.h>
#include <itkDisplacementFieldTransform.h>
#include <itkImageFileReader.h>
#include <itkMetaImageIO.h>
#include <itkTransformFactory.h>
#include <itkTransformFactoryBase.h>
#include <itkTransformFileReader.h>
#include <itkTxtTransformIO.h>

#include <fstream>
#include <iostream>
#include <limits>
#include <string>

namespace {

template <unsigned Dim>
using TransformPointer = typename itk::Transform<double, Dim, Dim>::Pointer;

template <unsigned Dim>
TransformPointer<Dim> read_displacement(const std::string& file) {
  using Transform = itk::DisplacementFieldTransform<double, Dim>;
  const auto reader = itk::ImageFileReader<typename Transform::DisplacementFieldType>::New();
  reader->SetImageIO(itk::MetaImageIO::New());
  reader->SetFileName(file);
  reader->Update();
  const auto transform = Transform::New();
  transform->SetDisplacementField(reader->GetOutput());
  return transform.GetPointer();
}

template <unsigned Dim>
TransformPointer<Dim> read_transform(const std::string& file) {
  itk::TransformFactoryBase::RegisterDefaultTransforms();
  // ITK's own list has cubic B-splines only.
  itk::TransformFactory<itk::BSplineTransform<double, Dim, 1>>::RegisterTransform();
  itk::TransformFactory<itk::BSplineTransform<double, Dim, 2>>::RegisterTransform();
  const auto reader = itk::TransformFileReaderTemplate<double>::New();
  reader->SetTransformIO(itk::TxtTransformIOTemplate<double>::New());
  reader->SetFileName(file);
  reader->Update();
  if (reader->GetTransformList()->size() != 1) throw std::runtime_error("not one transform");
  auto* transform = dynamic_cast<itk::Transform<double, Dim, Dim>*>(
      reader->GetTransformList()->front().GetPointer());
  if (transform == nullptr) throw std::runtime_error("a transform of another dimension");
  return transform;
}

template <unsigned Dim>
void map_points(const std::string& file, std::istream& in, std::ostream& out) {
  const bool is_field = file.ends_with(".mha");
  const auto transform = is_field ? read_displacement<Dim>(file) : read_transform<Dim>(file);
  out.precision(std::numeric_limits<double>::max_digits10);
  itk::Point<double, Dim> x;
  while (true) {
    for (unsigned a = 0; a < Dim; ++a) in >> x[a];
    if (!in) return;
    const auto y = transform->TransformPoint(x);
    for (unsigned a = 0; a < Dim; ++a) out << y[a] << (a + 1 < Dim ? ' ' : '\n');
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: itk_map_points DIM FILE IN OUT\n";
    return 2;
  }
  try {
    std::ifstream in(argv[3]);
    std::ofstream out(argv[4]);
    const bool plane = std::string(argv[1]) == "2";
    plane ? map_points<2>(argv[2], in, out) : map_points<3>(argv[2], in, out);
    if (!out.flush()) throw std::runtime_error("the points cannot be written");
  } catch (const std::exception& error) {
    std::cerr << "itk_map_points: " << error.what() << '\n';
    return 1;
  }
}
