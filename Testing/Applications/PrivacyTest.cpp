// Nothing of an input file's header but its geometry reaches an output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "Core/Error.h"
#include "Testing/Applications/CommandRunner.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

using ::testing::HasSubstr;
using testing::run_crease;

/// Every file below the folder, its path and content.
void expect_no_file_holds(const std::filesystem::path& folder, const std::string& text) {
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(testing::read_text(entry.path()).find(text), std::string::npos)
        << entry.path() << " holds " << text;
  }
}

/// A MetaImage whose header says more than geometry.
std::string image_with_identity(const testing::TemporaryFolder& folder, const std::string& name,
                                int shift) {
  std::string text =
      "ObjectType = Image\nNDims = 2\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
      "PatientName = Doe^Jane\nStudyDate = 19680229\nComment = secret-4711\nElementSpacing = 1 1\n"
      "DimSize = 32 32\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 32; ++i) {
      const int x = i - 16 - shift, y = j - 14;
      text += static_cast<char>(x * x + 2 * y * y < 80 ? 100 + 2 * (j % 5) : 10);
    }
  }
  return folder.write(name, text);
}

TEST(Privacy, HeadersOfMetaImagesStayBehind) {
  const testing::TemporaryFolder folder;
  const std::string fixed = image_with_identity(folder, "fixed.mha", 0);
  const std::string moving = image_with_identity(folder, "moving.mha", 1);
  const std::string output = (folder / "out").string();
  const auto run = run_crease({"register", "--fixed", fixed, "--moving", moving, "--mesh-size",
                               "12", "--output", output, "--quiet", "--levels", "1"});
  ASSERT_EQ(run.code, 0) << run.err;
  for (const char* text : {"Doe", "Jane", "19680229", "secret-4711"}) {
    expect_no_file_holds(output, text);
  }
}

/// Elements of a DICOM data set, explicit VR, little endian.
class DicomElements {
 public:
  void add(unsigned group, unsigned element, const std::string& vr, std::string value) {
    if (value.size() % 2 == 1) value += vr == "UI" ? '\0' : ' ';
    text_ += little(group, 2) + little(element, 2) + vr;
    const bool is_long = vr == "OB" || vr == "OW";
    text_ += is_long ? std::string(2, '\0') + little(value.size(), 4) : little(value.size(), 2);
    text_ += value;
  }
  void add_number(unsigned group, unsigned element, unsigned value) {
    add(group, element, "US", little(value, 2));
  }
  const std::string& text() const { return text_; }
  static std::string little(std::size_t value, int bytes) {
    std::string text;
    for (int b = 0; b < bytes; ++b) text += static_cast<char>(value >> (8 * b) & 255);
    return text;
  }

 private:
  std::string text_;
};

/// What must stay behind: names, numbers, dates, places, and the identifiers of study and images.
const std::vector<std::string> kSecrets = {
    "Doe",        "Jane",        "ID4711",     "19680229", "20040131",  "101112",       "ACC0815",
    "Sta. Clara", "Housedoctor", "knee hurts", "Scanner9", "PRIVATE17", "1.2.826.0.99", "072Y"};

/// A flat 32 x 32 DICOM image of a patient, with an ellipse `shift` pixels off the middle.
std::string dicom_of_patient(const testing::TemporaryFolder& folder, const std::string& name,
                             int shift) {
  const std::string storage = "1.2.840.10008.5.1.4.1.1.7", instance = "1.2.826.0.99." + name;
  DicomElements meta;
  meta.add(0x0002, 0x0001, "OB", std::string("\0\1", 2));
  meta.add(0x0002, 0x0002, "UI", storage);
  meta.add(0x0002, 0x0003, "UI", instance);
  meta.add(0x0002, 0x0010, "UI", "1.2.840.10008.1.2.1");
  meta.add(0x0002, 0x0012, "UI", "1.2.826.0.99");
  DicomElements length;
  length.add(0x0002, 0x0000, "UL", DicomElements::little(meta.text().size(), 4));
  DicomElements data;
  data.add(0x0008, 0x0016, "UI", storage);
  data.add(0x0008, 0x0018, "UI", instance);
  data.add(0x0008, 0x0020, "DA", "20040131");
  data.add(0x0008, 0x0030, "TM", "101112");
  data.add(0x0008, 0x0050, "SH", "ACC0815");
  data.add(0x0008, 0x0060, "CS", "OT");
  data.add(0x0008, 0x0080, "LO", "Sta. Clara");
  data.add(0x0008, 0x0090, "PN", "Housedoctor^A");
  data.add(0x0008, 0x1030, "LO", "knee hurts");
  data.add(0x0008, 0x1090, "LO", "Scanner9");
  data.add(0x0009, 0x0010, "LO", "PRIVATE17");
  data.add(0x0010, 0x0010, "PN", "Doe^Jane");
  data.add(0x0010, 0x0020, "LO", "ID4711");
  data.add(0x0010, 0x0030, "DA", "19680229");
  data.add(0x0010, 0x1010, "AS", "072Y");
  data.add(0x0020, 0x000d, "UI", "1.2.826.0.99.1");
  data.add(0x0020, 0x000e, "UI", "1.2.826.0.99.2");
  data.add_number(0x0028, 0x0002, 1);
  data.add(0x0028, 0x0004, "CS", "MONOCHROME2");
  data.add_number(0x0028, 0x0010, 32);
  data.add_number(0x0028, 0x0011, 32);
  data.add(0x0028, 0x0030, "DS", "0.5\\0.5");
  data.add_number(0x0028, 0x0100, 16);
  data.add_number(0x0028, 0x0101, 12);
  data.add_number(0x0028, 0x0102, 11);
  data.add_number(0x0028, 0x0103, 0);
  std::string pixels;
  for (int j = 0; j < 32; ++j) {
    for (int i = 0; i < 32; ++i) {
      const int x = i - 16 - shift, y = j - 14;
      pixels += DicomElements::little(x * x + 2 * y * y < 80 ? 1000 + 20 * (j % 5) : 100, 2);
    }
  }
  data.add(0x7fe0, 0x0010, "OW", pixels);
  return folder.write(name + ".dcm",
                      std::string(128, '\0') + "DICM" + length.text() + meta.text() + data.text());
}

// Every subcommand that reads images, with everything that it can write.
TEST(Privacy, NoOutputOfAnyCommandHoldsAPatient) {
  const testing::TemporaryFolder inputs, outputs;
  const std::string fixed = dicom_of_patient(inputs, "f", 0),
                    moving = dicom_of_patient(inputs, "m", 1);
  for (const std::string& secret : kSecrets) {
    ASSERT_THAT(testing::read_text(fixed), HasSubstr(secret));
  }
  const auto out = [&](const char* name) { return (outputs / name).string(); };
  int calls = 0;
  const auto call = [&](const std::vector<std::string>& arguments) {
    const auto run = run_crease(arguments);
    ASSERT_EQ(run.code, 0) << run.err;
    outputs.write(message("stdout-", ++calls), run.out);
    outputs.write(message("stderr-", calls), run.err);
  };
  call({"register", "--fixed", fixed, "--moving", moving, "--mesh-size", "6", "--levels", "1",
        "--json", "--output", out("spline")});
  call({"register", "--fixed", fixed, "--moving", moving, "--transform", "rigid", "--progress",
        "json", "--output", out("rigid")});
  const std::string transform = out("spline") + "/transform.json";
  for (const char* image : {"w.mha", "w.nii.gz", "w.nrrd", "w.tif", "w.png", "w.pgm"}) {
    call({"warp", "--transform", transform, "--moving", moving, "--reference", fixed,
          "--output-image", out(image), "--json"});
  }
  call({"warp", "--transform", transform, "--inverse", "--reference", fixed, "--displacement",
        out("u.nii.gz")});
  call({"phantom", "square", "--size", "64", "--output", out("phantom")});
  call({"evaluate", "--displacement", out("spline") + "/displacement.mha", "--fixed", fixed,
        "--moving", moving, "--output", out("evaluation"), "--json"});
  call({"info", fixed, "--json"});
  call({"info", transform});
  for (const std::string& secret : kSecrets) expect_no_file_holds(outputs.path(), secret);
}

TEST(Privacy, HeadersOfDicomFilesStayBehind) {
  const std::string file = testing::shared_file("readers/MR_small.dcm");
  if (file.empty()) GTEST_SKIP() << "the DICOM file is not there";
  // What the file does say about its patient.
  const std::string content = testing::read_text(file);
  ASSERT_THAT(content, HasSubstr("CompressedSamples^MR1"));
  ASSERT_THAT(content, HasSubstr("20040826"));
  const testing::TemporaryFolder folder;
  const std::string output = (folder / "out").string();
  const auto run = run_crease({"register", "--fixed", file, "--moving", file, "--transform",
                               "rigid", "--init", "identity", "--output", output, "--quiet"});
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/warped.mha"));
  for (const char* text : {"CompressedSamples", "20040826", "4MR1", "TOSHIBA"}) {
    expect_no_file_holds(output, text);
  }
}

}  // namespace
}  // namespace crease
