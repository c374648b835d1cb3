// The bytes of a picture, as stb_image reads them.
#pragma once

#include <stb_image.h>

#include <cstdint>
#include <span>

namespace simvis {

/// Returns whether a file is of Radiance HDR, by its first bytes.
bool is_hdr(std::span<const std::uint8_t> bytes);

/// stb_image takes what lacks at the end of a file as zeros. Its requests are noted here, so that such a file is known.
/// A run of HDR with length 0 lets stb_image wait for the next one, so it gets 0xFF behind the end of such a file.
class StbStream {
 public:
  explicit StbStream(std::span<const std::uint8_t> bytes) : left_(bytes), goes_on_(is_hdr(bytes)) {}

  /// The functions that read the stream; it is their `user`.
  static const stbi_io_callbacks& callbacks();

  /// More bytes were needed than the file has. PNG and JPEG end by marks of their own: ask for other kinds only.
  bool lacks_bytes() const { return lacks_bytes_; }

 private:
  static int read(void* user, char* out, int wanted);
  static void skip(void* user, int count);
  static int is_at_end(void* user);

  std::span<const std::uint8_t> left_;
  bool goes_on_, lacks_bytes_ = false;
};

/// The reason of a refusal, behind the name of the picture.
inline constexpr const char* kPictureEndsEarly = "cannot be decoded: the file ends too early";

}  // namespace simvis
