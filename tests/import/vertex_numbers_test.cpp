#include "import/programs/vertex_numbers.h"

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <map>
#include <random>

TEST_SUITE_BEGIN("import");

using namespace simvis;

namespace {

using Bits = std::array<std::uint32_t, 14>;

Bits bits_of(const glm::vec3& position, const VertexAttributes& attributes) {
  Bits bits;
  std::memcpy(bits.data(), &position, sizeof position);
  std::memcpy(bits.data() + 3, &attributes, sizeof attributes);
  return bits;
}

}  // namespace

TEST_CASE("vertices are numbered in input order, and bitwise equal ones once") {
  std::mt19937 random(3);
  Mesh mesh;
  VertexNumbers numbers;
  std::map<Bits, std::uint32_t> expected;
  // Few values of each component, so that vertices differ in any one of them and many repeat.
  const auto value = [&] { return static_cast<float>(random() % 3) - 1; };
  for (int i = 0; i < 50'000; ++i) {
    const glm::vec3 position{value(), value(), value()};
    VertexAttributes attributes;
    attributes.normal.x = value();
    attributes.uv[1].y = value();
    attributes.color.a = i % 7 == 0 ? static_cast<float>(i) : value();  // enough new ones for the table to grow
    const std::uint32_t number = numbers.add(mesh, position, attributes);
    const auto [known, is_new] =
        expected.try_emplace(bits_of(position, attributes), static_cast<std::uint32_t>(expected.size()));
    REQUIRE(number == known->second);
    REQUIRE(mesh.positions[number] == position);
    REQUIRE(mesh.attributes[number] == attributes);
  }
  CHECK(mesh.positions.size() == expected.size());
  CHECK(mesh.attributes.size() == expected.size());
  CHECK(expected.size() > 7000);
}

TEST_CASE("minus zero and zero are different vertices: bits count") {
  Mesh mesh;
  VertexNumbers numbers;
  CHECK(numbers.add(mesh, {0, 0, 0}, {}) == 0);
  CHECK(numbers.add(mesh, {-0.0f, 0, 0}, {}) == 1);
  CHECK(numbers.add(mesh, {0, 0, 0}, {}) == 0);
}

TEST_SUITE_END();
