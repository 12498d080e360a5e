#include "Applications/Sha256.h"

#include <gtest/gtest.h>

#include "Core/Error.h"
#include "Testing/TemporaryFolder.h"

namespace crease {
namespace {

std::string hash_of(const std::string& text) { return sha256(std::as_bytes(std::span(text))); }

// The examples of FIPS 180-4's companion and the well-known hash of nothing.
TEST(Sha256, ReproducesPublishedExamples) {
  EXPECT_EQ(hash_of(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(hash_of("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(hash_of("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(hash_of(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

// Files are read in pieces that do not fit the blocks of the hash.
TEST(Sha256, OfAFileIsThatOfItsBytes) {
  const testing::TemporaryFolder folder;
  const std::string content(200001, 'x');
  EXPECT_EQ(sha256_of_file(folder.write("f.bin", content)), hash_of(content));
  EXPECT_EQ(sha256_of_file(folder.write("empty", "")), hash_of(""));
  EXPECT_THROW(sha256_of_file(folder / "missing"), FileError);
}

}  // namespace
}  // namespace crease
