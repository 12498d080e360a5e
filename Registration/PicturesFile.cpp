#include "Images/ImageFile.h"
#include "Registration/Pictures.h"

namespace crease {

void write_picture(const std::filesystem::path& path, const Picture& picture) {
  write_rgb_png(path, picture.width, picture.height, picture.rgb);
}

}  // namespace crease
