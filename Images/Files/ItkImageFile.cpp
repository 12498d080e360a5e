#include "Images/Files/ItkImageFile.h"

#include <gdcmTrace.h>
#include <itkGDCMImageIO.h>
#include <itkJPEGImageIO.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkPNGImageIO.h>
#include <itkTIFFImageIO.h>
#include <nifti1_io.h>

#include <algorithm>
#include <cstdarg>
#include <iostream>
#include <limits>
#include <mutex>
#include <new>
#include <optional>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"

// ITK may bring a TIFF library of its own, under these names and without a header.
using TiffMessageHandler = void (*)(const char*, const char*, va_list);
// NOLINTBEGIN(readability-identifier-naming)
extern "C" __attribute__((weak)) TiffMessageHandler itk_TIFFSetWarningHandler(TiffMessageHandler);
extern "C" __attribute__((weak)) TiffMessageHandler itk_TIFFSetErrorHandler(TiffMessageHandler);
// NOLINTEND(readability-identifier-naming)

namespace crease {
namespace {

/// These libraries would write warnings of their own to the error stream.
void silence_libraries() {
  static std::once_flag once;
  std::call_once(once, [] {
    itk::Object::SetGlobalWarningDisplay(false);
    gdcm::Trace::DebugOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
    nifti_set_debug_level(0);
    if (itk_TIFFSetWarningHandler != nullptr) itk_TIFFSetWarningHandler(nullptr);
    if (itk_TIFFSetErrorHandler != nullptr) itk_TIFFSetErrorHandler(nullptr);
  });
}

itk::ImageIOBase::Pointer make_io(ImageFormat format) {
  silence_libraries();
  switch (format) {
    case ImageFormat::kPng:
      return itk::PNGImageIO::New().GetPointer();
    case ImageFormat::kJpeg:
      return itk::JPEGImageIO::New().GetPointer();
    case ImageFormat::kTiff:
      return itk::TIFFImageIO::New().GetPointer();
    case ImageFormat::kDicom:
      return itk::GDCMImageIO::New().GetPointer();
    case ImageFormat::kNifti:
      return itk::NiftiImageIO::New().GetPointer();
    case ImageFormat::kMetaImage:
      return itk::MetaImageIO::New().GetPointer();
    case ImageFormat::kNrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case ImageFormat::kPgm:
      break;
  }
  throw FileError("ITK does not read PGM files");
}

PixelType pixel_type(const std::filesystem::path& path, const itk::ImageIOBase& io) {
  using itk::IOComponentEnum;
  switch (io.GetComponentType()) {
    case IOComponentEnum::UCHAR:
      return PixelType::kUint8;
    case IOComponentEnum::CHAR:
      return PixelType::kInt8;
    case IOComponentEnum::USHORT:
      return PixelType::kUint16;
    case IOComponentEnum::SHORT:
      return PixelType::kInt16;
    case IOComponentEnum::UINT:
      return PixelType::kUint32;
    case IOComponentEnum::INT:
      return PixelType::kInt32;
    case IOComponentEnum::ULONG:
    case IOComponentEnum::ULONGLONG:
      return PixelType::kUint64;
    case IOComponentEnum::LONG:
    case IOComponentEnum::LONGLONG:
      return PixelType::kInt64;
    case IOComponentEnum::FLOAT:
      return PixelType::kFloat;
    case IOComponentEnum::DOUBLE:
      return PixelType::kDouble;
    default:
      fail(path, "pixels of this type are not supported; convert the file to float");
  }
}

itk::IOComponentEnum component_type(PixelType type) {
  using itk::IOComponentEnum;
  switch (type) {
    case PixelType::kUint8:
      return IOComponentEnum::UCHAR;
    case PixelType::kInt8:
      return IOComponentEnum::CHAR;
    case PixelType::kUint16:
      return IOComponentEnum::USHORT;
    case PixelType::kInt16:
      return IOComponentEnum::SHORT;
    case PixelType::kUint32:
      return IOComponentEnum::UINT;
    case PixelType::kInt32:
      return IOComponentEnum::INT;
    case PixelType::kUint64:
      return IOComponentEnum::ULONG;
    case PixelType::kInt64:
      return IOComponentEnum::LONG;
    case PixelType::kFloat:
      return IOComponentEnum::FLOAT;
    case PixelType::kDouble:
      break;
  }
  return IOComponentEnum::DOUBLE;
}

bool is_colour(ImageFormat format, const itk::ImageIOBase& io) {
  const auto type = io.GetPixelType();
  if (type == itk::IOPixelEnum::RGB || type == itk::IOPixelEnum::RGBA) return true;
  return !has_spacing(format) && io.GetNumberOfComponents() > 1;
}

RawImage header_of(const std::filesystem::path& path, ImageFormat format,
                   const itk::ImageIOBase& io) {
  RawImage image;
  const std::size_t dimension = io.GetNumberOfDimensions();
  image.set_plain_geometry(dimension);
  double bytes = static_cast<double>(io.GetComponentSize()) * io.GetNumberOfComponents();
  for (std::size_t a = 0; a < dimension; ++a) {
    const auto axis = static_cast<unsigned>(a);
    const auto size = io.GetDimensions(axis);
    bytes *= static_cast<double>(size);
    if (size < 1 || size > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
        bytes > 1e13) {
      fail(path, message("axis ", a + 1, " of the image has ", size, " pixels"));
    }
    image.size.push_back(static_cast<int>(size));
    if (!has_spacing(format)) continue;
    image.spacing[a] = io.GetSpacing(axis);
    image.origin[a] = io.GetOrigin(axis);
    const auto direction = io.GetDirection(axis);
    std::copy_n(direction.begin(), dimension, image.direction.begin() + a * dimension);
  }
  image.type = pixel_type(path, io);
  image.num_components = static_cast<int>(io.GetNumberOfComponents());
  image.colour = is_colour(format, io);
  return image;
}

void set_whole_region(itk::ImageIOBase& io, const RawImage& image) {
  itk::ImageIORegion region(static_cast<unsigned>(image.size.size()));
  for (std::size_t a = 0; a < image.size.size(); ++a) {
    region.SetIndex(a, 0);
    region.SetSize(a, static_cast<itk::SizeValueType>(image.size[a]));
  }
  io.SetIORegion(region);
}

/// Keeps MetaIO's own words on a full disk off the error stream, one writer at a time.
class QuietErrorStream {
 public:
  QuietErrorStream() : lock_(mutex()), buffer_(std::cerr.rdbuf(nullptr)) {}
  ~QuietErrorStream() { std::cerr.rdbuf(buffer_); }
  QuietErrorStream(const QuietErrorStream&) = delete;
  QuietErrorStream& operator=(const QuietErrorStream&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  std::streambuf* buffer_;
};

/// Calls work() and turns what ITK throws into a FileError.
template <typename Work>
void guarded(const std::filesystem::path& path, const char* doing, Work&& work) {
  try {
    work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(path, message("there is not enough memory for ", doing, " the image"));
  } catch (const itk::ExceptionObject& error) {
    fail(path, message(doing, " the image failed: ", error.GetDescription()));
  } catch (const std::exception& error) {
    fail(path, message(doing, " the image failed: ", error.what()));
  }
}

}  // namespace

RawImage read_with_itk(const std::filesystem::path& path, ImageFormat format, bool with_pixels) {
  RawImage image;
  guarded(path, "reading", [&] {
    const auto io = make_io(format);
    io->SetFileName(path.string());
    io->ReadImageInformation();
    image = header_of(path, format, *io);
    if (!with_pixels) return;
    if (io->GetImageSizeInBytes() != image.num_bytes()) {
      fail(path, "pixels of this type are not supported; convert the file to float");
    }
    set_whole_region(*io, image);
    image.allocate();
    io->Read(image.data.get());
  });
  return image;
}

void write_with_itk(const std::filesystem::path& path, ImageFormat format, const RawImage& image) {
  guarded(path, "writing", [&] {
    const auto io = make_io(format);
    const auto dimension = static_cast<unsigned>(image.size.size());
    io->SetFileName(path.string());
    io->SetNumberOfDimensions(dimension);
    for (unsigned a = 0; a < dimension; ++a) {
      std::vector<double> axis(dimension);
      std::copy_n(image.direction.begin() + a * dimension, dimension, axis.begin());
      io->SetDimensions(a, static_cast<itk::SizeValueType>(image.size[a]));
      io->SetSpacing(a, image.spacing[a]);
      io->SetOrigin(a, image.origin[a]);
      io->SetDirection(a, axis);
    }
    io->SetComponentType(component_type(image.type));
    io->SetNumberOfComponents(static_cast<unsigned>(image.num_components));
    io->SetPixelType(image.num_components == 1 ? itk::IOPixelEnum::SCALAR
                                               : itk::IOPixelEnum::VECTOR);
    // PNG is always compressed; the lowest level takes a third of the time for a tenth more bytes.
    io->SetUseCompression(format == ImageFormat::kPng);
    if (format == ImageFormat::kPng) io->SetCompressionLevel(1);
    set_whole_region(*io, image);
    std::optional<QuietErrorStream> quiet;
    if (format == ImageFormat::kMetaImage) quiet.emplace();
    io->WriteImageInformation();
    io->Write(image.data.get());
  });
}

}  // namespace crease
