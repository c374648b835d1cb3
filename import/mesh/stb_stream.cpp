#include "import/mesh/stb_stream.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace simvis {
namespace {

// stb_image asks for this many bytes ahead, and for other numbers only if it needs them now.
constexpr int kBytesAhead = 128;

}  // namespace

bool is_hdr(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kStartBytes = 16;
  return stbi_is_hdr_from_memory(bytes.data(), static_cast<int>(std::min(bytes.size(), kStartBytes))) != 0;
}

const stbi_io_callbacks& StbStream::callbacks() {
  static constexpr stbi_io_callbacks kCallbacks{.read = read, .skip = skip, .eof = is_at_end};
  return kCallbacks;
}

int StbStream::read(void* user, char* out, int wanted) {
  auto& stream = *static_cast<StbStream*>(user);
  const std::size_t count = std::min(stream.left_.size(), static_cast<std::size_t>(std::max(wanted, 0)));
  const bool is_short = count < static_cast<std::size_t>(std::max(wanted, 0));
  if (is_short && (count == 0 || wanted != kBytesAhead)) stream.lacks_bytes_ = true;
  std::memcpy(out, stream.left_.data(), count);
  stream.left_ = stream.left_.subspan(count);
  if (count > 0 || wanted <= 0 || !stream.goes_on_) return static_cast<int>(count);
  std::memset(out, 0xFF, static_cast<std::size_t>(wanted));
  return wanted;
}

void StbStream::skip(void* user, int count) {
  auto& stream = *static_cast<StbStream*>(user);
  stream.left_ = stream.left_.subspan(std::min(stream.left_.size(), static_cast<std::size_t>(std::max(count, 0))));
}

int StbStream::is_at_end(void* user) { return static_cast<StbStream*>(user)->left_.empty() ? 1 : 0; }

}  // namespace simvis
