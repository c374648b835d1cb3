#include "import/programs/clouds/lzf.h"

namespace simvis {

std::optional<std::vector<std::uint8_t>> lzf_data(std::span<const std::uint8_t> compressed, std::size_t size) {
  constexpr std::size_t kLongRun = 7, kLiterals = 32, kMaxRun = kLongRun + 255 + 2;
  if (size / kMaxRun > compressed.size()) return {};  // so that a wrong size costs no memory
  std::vector<std::uint8_t> data;
  data.reserve(size);
  std::size_t at = 0;
  while (at < compressed.size()) {
    const std::size_t control = compressed[at++];
    if (control < kLiterals) {
      const std::size_t count = control + 1;
      if (count > compressed.size() - at || count > size - data.size()) return {};
      data.insert(data.end(), compressed.begin() + static_cast<std::ptrdiff_t>(at),
                  compressed.begin() + static_cast<std::ptrdiff_t>(at + count));
      at += count;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == kLongRun) {
      if (at == compressed.size()) return {};
      length += compressed[at++];
    }
    if (at == compressed.size()) return {};
    const std::size_t distance = ((control & (kLiterals - 1)) << 8 | compressed[at++]) + 1;
    length += 2;
    if (distance > data.size() || length > size - data.size()) return {};
    // The repeated bytes may reach into themselves.
    for (std::size_t i = 0; i < length; ++i) data.push_back(data[data.size() - distance]);
  }
  if (data.size() != size) return {};
  return data;
}

}  // namespace simvis
