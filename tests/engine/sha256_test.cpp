#include "engine/base/sha256.h"

#include <doctest/doctest.h>

#include <fstream>
#include <string>

#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

// The examples of FIPS 180-4 (NIST, "Example Algorithms", SHA-256), and a file of more than one piece.
TEST_CASE("SHA-256 gives the hashes that the standard lists, of texts and of files") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& text, const std::string& hash) {
    const auto file = folder / "file";
    std::ofstream(file, std::ios::binary) << text;
    CHECK(sha256_of_text(text) == hash);
    CHECK(sha256_of(file) == hash);
  };
  check("", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  check("abc", "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  check("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq",
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  check(std::string(1'000'000, 'a'), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  check(std::string(3'000'000, '\0'), "35bce4eae54ec8e6cc2868baa8d157914d6ae2858811b4cc0c078c94460fa26f");
}

TEST_SUITE_END();
