// small_picture WIDTH OUT.png IN ...: places pictures side by side, shrinks them to WIDTH pixels in all and
// writes them with 256 colours, so that the guide's pictures stay small. IN is a PNG picture that crease
// drew, or IMAGE=TITLE for any image or label file, which is drawn first.
#include <itkImage.h>
#include <itkImageFileReader.h>
#include <itkPNGImageIO.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "Images/ImageFile.h"
#include "Registration/Pictures.h"

namespace crease {
namespace {

using Colour = std::array<int, 3>;

Picture read_png(const std::string& path) {
  using Pixels = itk::Image<itk::RGBPixel<std::uint8_t>, 2>;
  const auto reader = itk::ImageFileReader<Pixels>::New();
  reader->SetImageIO(itk::PNGImageIO::New());
  reader->SetFileName(path);
  reader->Update();
  const auto size = reader->GetOutput()->GetBufferedRegion().GetSize();
  Picture picture{static_cast<int>(size[0]), static_cast<int>(size[1]), {}};
  const auto* bytes = reader->GetOutput()->GetBufferPointer()->GetDataPointer();
  picture.rgb.assign(bytes, bytes + std::size_t{3} * size[0] * size[1]);
  return picture;
}

Picture picture_of(const std::string& argument) {
  const auto equals = argument.find('=');
  if (equals == std::string::npos) return read_png(argument);
  return image_picture(read_image<2>(argument.substr(0, equals)).image,
                       argument.substr(equals + 1));
}

/// Left to right, tops aligned, on white.
Picture joined(const std::vector<Picture>& pictures) {
  Picture result;
  for (const Picture& p : pictures) {
    result.width += p.width;
    result.height = std::max(result.height, p.height);
  }
  result.rgb.assign(std::size_t{3} * result.width * result.height, 255);
  int left = 0;
  for (const Picture& p : pictures) {
    for (int y = 0; y < p.height; ++y) {
      std::copy_n(p.rgb.begin() + std::ptrdiff_t{3} * y * p.width, 3 * p.width,
                  result.rgb.begin() + std::ptrdiff_t{3} * (y * result.width + left));
    }
    left += p.width;
  }
  return result;
}

/// Along rows: each new pixel is the mean over the old ones that it covers.
Picture shrunk_to_width(const Picture& picture, int width) {
  Picture result{width, picture.height, {}};
  result.rgb.resize(std::size_t{3} * result.width * result.height);
  const double scale = double(picture.width) / width;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double from = x * scale, to = std::min<double>((x + 1) * scale, picture.width);
      std::array<double, 3> sum{};
      for (int i = static_cast<int>(from); i < to; ++i) {
        const double share = std::min<double>(i + 1, to) - std::max<double>(i, from);
        for (int c = 0; c < 3; ++c) sum[c] += share * picture.rgb[3 * (y * picture.width + i) + c];
      }
      for (int c = 0; c < 3; ++c) {
        result.rgb[3 * (y * width + x) + c] =
            static_cast<std::uint8_t>(std::lround(sum[c] / (to - from)));
      }
    }
  }
  return result;
}

Picture transposed(const Picture& picture) {
  Picture result{picture.height, picture.width, picture.rgb};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      std::copy_n(&picture.rgb[3 * (y * picture.width + x)], 3,
                  &result.rgb[3 * (x * picture.height + y)]);
    }
  }
  return result;
}

Picture shrunk(const Picture& picture, int width) {
  if (width >= picture.width) return picture;
  const int height = static_cast<int>(std::lround(double(picture.height) * width / picture.width));
  return transposed(shrunk_to_width(transposed(shrunk_to_width(picture, width)), height));
}

/// The nearest of 64 steps per channel; ends stay.
Colour rounded(const std::uint8_t* rgb) {
  Colour colour;
  for (int c = 0; c < 3; ++c) colour[c] = static_cast<int>(std::lround(rgb[c] * 63 / 255.0));
  return colour;
}

/// The 256 colours that occur most, and for every colour the number of the nearest of them.
struct Palette {
  std::vector<Colour> colours;
  std::map<Colour, std::uint8_t> numbers;

  explicit Palette(const Picture& picture) {
    std::map<Colour, int> counts;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) ++counts[rounded(&picture.rgb[i])];
    std::vector<std::pair<int, Colour>> order;
    for (const auto& [colour, count] : counts) order.emplace_back(-count, colour);
    std::ranges::sort(order);
    for (std::size_t k = 0; k < std::min<std::size_t>(256, order.size()); ++k) {
      colours.push_back(order[k].second);
    }
    for (const auto& [colour, count] : counts) numbers[colour] = nearest(colour);
  }

  std::uint8_t nearest(const Colour& wanted) const {
    const auto distance = [&](const Colour& colour) {
      int sum = 0;
      for (int c = 0; c < 3; ++c) sum += (colour[c] - wanted[c]) * (colour[c] - wanted[c]);
      return sum;
    };
    return static_cast<std::uint8_t>(std::ranges::min_element(colours, {}, distance) -
                                     colours.begin());
  }
};

void write_with_palette(const std::string& path, const Picture& picture) {
  const Palette palette(picture);
  std::vector<std::uint8_t> numbers;
  for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
    numbers.push_back(palette.numbers.at(rounded(&picture.rgb[i])));
  }
  itk::PNGImageIO::PaletteType colours;
  for (const Colour& colour : palette.colours) {
    itk::RGBPixel<std::uint8_t> pixel;
    for (int c = 0; c < 3; ++c)
      pixel[c] = static_cast<std::uint8_t>(std::lround(colour[c] * 255 / 63.0));
    colours.push_back(pixel);
  }
  const auto io = itk::PNGImageIO::New();
  io->SetFileName(path);
  io->SetNumberOfDimensions(2);
  io->SetDimensions(0, picture.width);
  io->SetDimensions(1, picture.height);
  io->SetPixelType(itk::IOPixelEnum::SCALAR);
  io->SetComponentType(itk::IOComponentEnum::UCHAR);
  io->SetNumberOfComponents(1);
  io->SetWritePalette(true);
  io->SetColorPalette(colours);
  io->SetUseCompression(true);
  io->SetCompressionLevel(9);
  io->Write(numbers.data());
}

}  // namespace
}  // namespace crease

int main(int argc, char** argv) try {
  if (argc < 4) {
    std::cerr << "usage: small_picture WIDTH OUT.png IN ...\n";
    return 2;
  }
  std::vector<crease::Picture> pictures;
  for (int i = 3; i < argc; ++i) pictures.push_back(crease::picture_of(argv[i]));
  crease::write_with_palette(argv[2], crease::shrunk(crease::joined(pictures), std::stoi(argv[1])));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "small_picture: " << error.what() << "\n";
  return 1;
}
