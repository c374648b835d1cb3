#include "scenegraph/array_bytes.h"

#include <cstring>
#include <variant>

namespace simvis {

std::size_t own_size(const MeasuredArray& array) {
  return std::visit([&](const auto& all) { return array.count() * sizeof *all.data(); }, array.numbers);
}

void copy_numbers(const MeasuredArray& array, void* to) {
  const std::size_t count = array.count();
  if (count == 0) return;
  const auto copy = [&]<typename Number>(const SharedArray<Number>& numbers) {
    auto* bytes = static_cast<std::uint8_t*>(to);
    if (array.stride == 1) {
      std::memcpy(bytes, numbers.data() + array.first, count * sizeof(Number));
      return;
    }
    for (std::size_t i = 0; i < count; ++i, bytes += sizeof(Number)) {
      std::memcpy(bytes, &numbers[array.first + i * array.stride], sizeof(Number));
    }
  };
  std::visit(copy, array.numbers);
}

std::vector<std::uint8_t> own_bytes(const MeasuredArray& array) {
  std::vector<std::uint8_t> bytes(own_size(array));
  copy_numbers(array, bytes.data());
  return bytes;
}

}  // namespace simvis
