#include "engine/base/sha256.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <array>
#include <cassert>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>

#include "engine/base/file_pieces.h"

namespace simvis {

namespace {

/// The hash of bytes that come in pieces. libcrypto makes it, which uses the processor's own instructions.
class Sha256 {
 public:
  Sha256() {
    // The user's openssl.cnf says nothing that matters here, and reading it takes longer than most files' hashes.
    OPENSSL_init_crypto(OPENSSL_INIT_NO_LOAD_CONFIG, nullptr);
    context_.reset(EVP_MD_CTX_new());
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) {
      throw std::runtime_error("libcrypto has no SHA-256");
    }
  }

  void add(const void* bytes, std::size_t size) {
    [[maybe_unused]] const int added = EVP_DigestUpdate(context_.get(), bytes, size);
    assert(added == 1);
  }

  std::string digits() {
    std::array<std::uint8_t, 32> hash{};
    [[maybe_unused]] const int ended = EVP_DigestFinal_ex(context_.get(), hash.data(), nullptr);
    assert(ended == 1);
    std::string digits;
    for (const std::uint8_t byte : hash) {
      for (const int half : {byte >> 4, byte & 15}) digits += "0123456789abcdef"[half];
    }
    return digits;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_{nullptr, EVP_MD_CTX_free};
};

}  // namespace

std::string sha256_of(const std::filesystem::path& file) {
  Sha256 hash;
  read_in_pieces(file, [&](std::span<const std::uint8_t> piece) { hash.add(piece.data(), piece.size()); });
  return hash.digits();
}

std::string sha256_of_text(std::string_view text) {
  Sha256 hash;
  hash.add(text.data(), text.size());
  return hash.digits();
}

}  // namespace simvis
