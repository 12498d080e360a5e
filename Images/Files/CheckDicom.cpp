#include <cstdlib>
#include <map>

#include "Core/Error.h"
#include "Images/Files/FileBytes.h"
#include "Images/Files/FileChecks.h"
#include "Images/Files/TextHeader.h"

namespace crease {
namespace {

constexpr std::uint32_t kUndefinedLength = 0xffffffffu;
constexpr int kDeepest = 64;  // sequences within sequences

/// A tag as one number: group in the upper half.
constexpr std::uint32_t kStorageClass = 0x00020002, kTransferSyntax = 0x00020010,
                        kSopClass = 0x00080016, kModality = 0x00080060, kFrameOffsets = 0x3004000c,
                        kSamples = 0x00280002, kPhotometric = 0x00280004, kFrames = 0x00280008,
                        kRows = 0x00280010, kColumns = 0x00280011, kPixelSpacing = 0x00280030,
                        kImagerPixelSpacing = 0x00181164, kBits = 0x00280100, kPixels = 0x7fe00010,
                        kItem = 0xfffee000, kItemEnd = 0xfffee00d, kSequenceEnd = 0xfffee0dd;

constexpr std::string_view kDoseClass = "1.2.840.10008.5.1.4.1.1.481.2";

struct Element {
  std::uint32_t tag = 0;
  std::uint32_t length = 0;
  std::uint64_t data = 0;      // offset
  bool explicit_items = true;  // whether value representations stand in what lies inside
  bool sequence = false;       // known to hold items
};

/// Goes through the elements of a DICOM file, without understanding more than where each one ends.
class DicomWalker {
 public:
  DicomWalker(const std::filesystem::path& path, Bytes bytes)
      : path_(path), bytes_(bytes), reader_(bytes, false) {}

  DicomFacts check() {
    std::uint64_t at = 132;
    std::string syntax;
    while (reader_.holds(at, 8) && reader_.number(at, 2) == 2) {
      const Element element = read_element(at, true);
      if (element.length == kUndefinedLength) damaged();
      if (element.tag == kTransferSyntax) syntax = text(element);
      if (element.tag == kStorageClass) dose_ = text(element) == kDoseClass;
      at = element.data + element.length;
    }
    if (syntax.empty()) damaged();
    if (syntax == "1.2.840.10008.1.2.1.99") {
      fail(path_, "deflated DICOM is not supported; convert it, for example with dcmconv +te");
    }
    explicit_ = syntax != "1.2.840.10008.1.2";
    reader_ = ByteReader(bytes_, syntax == "1.2.840.10008.1.2.2");
    walk_data_set(at);
    facts_.has_spacing = mentions(kPixelSpacing) || mentions(kImagerPixelSpacing);
    return facts_;
  }

 private:
  [[noreturn]] void damaged() const { fail(path_, "the DICOM file is truncated or damaged"); }

  std::uint32_t tag(std::uint64_t at) const {
    return static_cast<std::uint32_t>(reader_.number(at, 2) << 16 | reader_.number(at + 2, 2));
  }
  /// Whether the tag stands anywhere before the pixels: spacings may be deep inside sequences.
  bool mentions(std::uint32_t wanted) const {
    for (std::uint64_t at = 132; at + 8 <= pixels_at_; at += 2) {
      if (tag(at) == wanted) return true;
    }
    return false;
  }
  std::string text(const Element& element) const {
    auto value = trimmed(reader_.text(element.data, element.length));
    while (value.ends_with('\0')) value.remove_suffix(1);
    return std::string(trimmed(value));
  }

  Element read_element(std::uint64_t at, bool is_explicit) const {
    if (!reader_.holds(at, 8)) fail_truncated(path_, at + 8, reader_.size());
    Element element;
    element.tag = tag(at);
    element.explicit_items = is_explicit;
    const bool delimiter = element.tag >> 16 == 0xfffe;
    std::uint64_t header = 8;
    if (!is_explicit || delimiter) {
      element.length = static_cast<std::uint32_t>(reader_.number(at + 4, 4));
    } else {
      const std::string_view vr = reader_.text(at + 4, 2);
      if (vr[0] < 'A' || vr[0] > 'Z' || vr[1] < 'A' || vr[1] > 'Z') damaged();
      element.sequence = vr == "SQ";
      element.explicit_items = vr != "UN";  // unknown sequences are written without
      constexpr std::string_view kLong = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
      if (kLong.find(vr) != std::string_view::npos) {
        if (!reader_.holds(at, 12)) fail_truncated(path_, at + 12, reader_.size());
        element.length = static_cast<std::uint32_t>(reader_.number(at + 8, 4));
        header = 12;
      } else {
        element.length = static_cast<std::uint32_t>(reader_.number(at + 6, 2));
      }
    }
    element.data = at + header;
    if (element.length != kUndefinedLength && !reader_.holds(element.data, element.length)) {
      fail_truncated(path_, element.data + element.length, reader_.size());
    }
    return element;
  }

  /// Where an element ends. Sequences are looked through, as far as they can be told from plain values.
  std::uint64_t skip(const Element& element, int depth) const {
    if (depth > kDeepest) damaged();
    const bool open = element.length == kUndefinedLength;
    if (!open && !element.sequence) return element.data + element.length;
    const std::uint64_t end = open ? reader_.size() : element.data + element.length;
    std::uint64_t at = element.data;
    while (open || at < end) {
      const Element item = read_element(at, element.explicit_items);
      if (item.tag == kSequenceEnd && open) return item.data;
      if (item.tag != kItem) damaged();
      at = element.tag == kPixels ? item.data + item.length  // a fragment of compressed pixels
                                  : skip_item(item, depth + 1);
      if (at > end) damaged();
    }
    return at;
  }
  std::uint64_t skip_item(const Element& item, int depth) const {
    const bool open = item.length == kUndefinedLength;
    const std::uint64_t end = open ? reader_.size() : item.data + item.length;
    std::uint64_t at = item.data;
    while (open || at < end) {
      const Element element = read_element(at, item.explicit_items);
      if (element.tag == kItemEnd && open) return element.data;
      at = skip(element, depth + 1);
      if (at > end) damaged();
    }
    return at;
  }

  void walk_data_set(std::uint64_t at) {
    bool pixels = false;
    while (at < reader_.size()) {
      const Element element = read_element(at, explicit_);
      if (element.tag == kPixels) {
        check_pixels(element);
        pixels = true;
        pixels_at_ = at;
      }
      if (element.tag == kPhotometric) facts_.monochrome1 = text(element) == "MONOCHROME1";
      if (element.tag == kSopClass && text(element) == kDoseClass) dose_ = true;
      if (element.tag == kModality && text(element) == "RTDOSE") dose_ = true;
      if (element.tag == kFrameOffsets) {
        const std::string values = text(element);
        offsets_ = values.find('\\') != std::string::npos &&
                   values.find_first_not_of("0123456789+-.eE\\ ") == std::string::npos;
      }
      if (element.tag == kFrames) {
        numbers_[kFrames] = std::strtoull(text(element).c_str(), nullptr, 10);
      }
      if (element.tag == kRows || element.tag == kColumns || element.tag == kBits ||
          element.tag == kSamples) {
        if (element.length != 2) damaged();
        numbers_[element.tag] = reader_.number(element.data, 2);
      }
      at = skip(element, 0);
    }
    if (!pixels) fail(path_, "the DICOM file holds no image");
    if (dose_ && numbers_[kFrames] > 1 && !offsets_) {
      fail(path_, "the dose file does not say where its frames lie");
    }
  }

  void check_pixels(const Element& pixels) {
    for (const std::uint32_t needed : {kRows, kColumns, kBits}) {
      if (numbers_[needed] == 0) fail(path_, "the DICOM file does not say how large its image is");
    }
    const auto frames = std::max<std::uint64_t>(1, numbers_[kFrames]);
    const auto samples = std::max<std::uint64_t>(1, numbers_[kSamples]);
    if (frames > 1'000'000 || samples > 4 || numbers_[kBits] > 64) damaged();
    if (pixels.length == kUndefinedLength) return;  // compressed, in fragments
    const auto bits = numbers_[kRows] * numbers_[kColumns] * numbers_[kBits] * samples * frames;
    if (pixels.length < (bits + 7) / 8) {
      fail(path_, message("the DICOM file holds ", pixels.length,
                          " bytes of pixels where its image "
                          "needs ",
                          (bits + 7) / 8));
    }
  }

  const std::filesystem::path& path_;
  Bytes bytes_;
  ByteReader reader_;
  bool explicit_ = true;
  bool dose_ = false, offsets_ = false;  // a dose file, where frames lie at given offsets
  std::uint64_t pixels_at_ = 0;
  DicomFacts facts_;
  std::map<std::uint32_t, std::uint64_t> numbers_;
};

}  // namespace

DicomFacts check_dicom(const std::filesystem::path& path) {
  const auto bytes = read_bytes(path);
  if (ByteReader(bytes, false).text(128, 4) != "DICM") {
    fail(path,
         "this is not a DICOM file: the mark DICM at byte 128 is missing; a file without header "
         "can be mended by dcmconv");
  }
  return DicomWalker(path, bytes).check();
}

}  // namespace crease
