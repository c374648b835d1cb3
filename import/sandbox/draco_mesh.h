// A mesh that the program simvis-decode reads from Draco data, as plain data, and its serialization.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace simvis {

/// An attribute that is wanted, in the layout of a glTF accessor.
struct DracoAttribute {
  std::uint32_t id = 0;          ///< its number in the Draco data
  int component_type = 0;        ///< 5120 to 5126, as in glTF
  std::uint32_t components = 1;  ///< per vertex

  std::size_t bytes() const;  ///< per vertex; 0 for an unknown component type
};

struct DracoMesh {
  std::uint64_t vertices = 0;
  std::vector<std::uint32_t> indices;                 ///< of triangles, each below `vertices`
  std::vector<std::vector<std::uint8_t>> attributes;  ///< in the order of the request, without gaps
};

/// The attribute as an argument of the program, and back. Returns false for a text that says something else.
std::string to_argument(const DracoAttribute& attribute);
bool parse_argument(const std::string& text, DracoAttribute& attribute);

std::vector<std::uint8_t> pack_draco_mesh(const DracoMesh& mesh);

/// Does not trust `bytes`. Returns false if their number or an index does not fit.
bool unpack_draco_mesh(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> attributes,
                       DracoMesh& mesh);

}  // namespace simvis
