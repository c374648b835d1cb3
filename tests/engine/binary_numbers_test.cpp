#include "engine/base/binary_numbers.h"

#include <doctest/doctest.h>

#include <cstdint>
#include <string_view>
#include <vector>

TEST_SUITE_BEGIN("engine");

using namespace simvis;

TEST_CASE("numbers are appended and read back, little-endian and without gaps") {
  std::string bytes;
  append_binary(bytes, std::uint8_t{0x01});
  append_binary(bytes, std::uint32_t{0x05040302});
  append_lowest(bytes, std::uint64_t{0x99080706}, 3);
  append_binary_all<std::uint16_t>(bytes, std::vector<std::uint16_t>{0x0a09, 0x0c0b});
  append_binary_all<double>(bytes, {});
  CHECK(bytes == "\x01\x02\x03\x04\x05\x06\x07\x08\x09\x0a\x0b\x0c");
  CHECK(binary_at<std::uint32_t>(bytes, 1) == 0x05040302);
  CHECK(binary_at<std::uint16_t>(std::string_view(bytes), 10) == 0x0c0b);
  std::string number;
  append_binary(number, -1.25);
  CHECK(binary_at<double>(number, 0) == -1.25);
}
