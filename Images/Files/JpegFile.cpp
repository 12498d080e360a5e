#include "Images/Files/JpegFile.h"

#include <csetjmp>
#include <cstdio>
// libjpeg's header leaves it to others to declare FILE.
#include <jerror.h>
#include <jpeglib.h>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"

namespace crease {
namespace {

/// libjpeg reports errors through these functions; an error jumps back to whoever called it.
struct ErrorManager {
  jpeg_error_mgr base;
  std::jmp_buf caller;
  char text[JMSG_LENGTH_MAX] = {};
  bool damaged = false;
};

ErrorManager& manager_of(j_common_ptr info) { return *reinterpret_cast<ErrorManager*>(info->err); }

[[noreturn]] void on_error(j_common_ptr info) {
  ErrorManager& errors = manager_of(info);
  info->err->format_message(info, errors.text);
  std::longjmp(errors.caller, 1);
}

void on_warning(j_common_ptr info, int level) {
  if (level >= 0) return;  // a trace, not a warning
  const int code = info->err->msg_code;
  if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE) {
    manager_of(info).damaged = true;
  }
}

/// Decodes into rows that the caller provides. Between setjmp and longjmp there are no objects with
/// destructors, as C++ demands.
class Decoder {
 public:
  explicit Decoder(Bytes bytes) {
    info_.err = jpeg_std_error(&errors_.base);
    errors_.base.error_exit = on_error;
    errors_.base.emit_message = on_warning;
    if (setjmp(errors_.caller) != 0) return;
    jpeg_create_decompress(&info_);
    jpeg_mem_src(&info_, bytes.data(), static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&info_, TRUE);
    if (info_.jpeg_color_space != JCS_GRAYSCALE) info_.out_color_space = JCS_RGB;
    jpeg_calc_output_dimensions(&info_);
    good_ = true;
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;
  ~Decoder() { jpeg_destroy_decompress(&info_); }

  bool decode(std::uint8_t* pixels) {
    if (setjmp(errors_.caller) != 0) return false;
    jpeg_start_decompress(&info_);
    const std::size_t stride = std::size_t{info_.output_width} * info_.output_components;
    while (info_.output_scanline < info_.output_height) {
      JSAMPROW row = pixels + stride * info_.output_scanline;
      jpeg_read_scanlines(&info_, &row, 1);
    }
    jpeg_finish_decompress(&info_);
    return !errors_.damaged;
  }

  bool good() const { return good_; }
  const jpeg_decompress_struct& info() const { return info_; }
  std::string error() const {
    return errors_.text[0] != 0 ? errors_.text : "its data are truncated or damaged";
  }

 private:
  jpeg_decompress_struct info_{};
  ErrorManager errors_{};
  bool good_ = false;
};

}  // namespace

RawImage read_jpeg(const std::filesystem::path& path, bool with_pixels) {
  const auto bytes = read_bytes(path);
  if (ByteReader(bytes, true).number(0, 2) != 0xffd8) fail(path, "this is not a JPEG file");
  Decoder decoder(bytes);
  if (!decoder.good()) fail(path, "the JPEG file cannot be read: " + decoder.error());
  if (decoder.info().jpeg_color_space == JCS_CMYK || decoder.info().jpeg_color_space == JCS_YCCK) {
    fail(path, "JPEG files in printing colours (CMYK) are not supported; convert it to PNG");
  }
  RawImage image;
  image.size = {static_cast<int>(decoder.info().output_width),
                static_cast<int>(decoder.info().output_height)};
  image.set_plain_geometry(2);
  image.num_components = decoder.info().output_components;
  image.colour = image.num_components == 3;
  if (!with_pixels) return image;
  image.allocate();
  if (!decoder.decode(image.values<std::uint8_t>())) {
    fail(path, "the JPEG file cannot be read: " + decoder.error());
  }
  return image;
}

}  // namespace crease
