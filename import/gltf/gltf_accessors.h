// Reads accessors of every component type, normalised, strided and sparse, and never a byte outside the buffer view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "import/gltf/gltf_document.h"

namespace simvis {

/// Component formats, as bits of a set. The suffix _n means normalised to [0, 1] or [-1, 1].
inline constexpr unsigned kGltfI8 = 1;
inline constexpr unsigned kGltfU8 = 2;
inline constexpr unsigned kGltfI16 = 4;
inline constexpr unsigned kGltfU16 = 8;
inline constexpr unsigned kGltfU32 = 16;
inline constexpr unsigned kGltfF32 = 32;
inline constexpr unsigned kGltfI8n = 64;
inline constexpr unsigned kGltfU8n = 128;
inline constexpr unsigned kGltfI16n = 256;
inline constexpr unsigned kGltfU16n = 512;

/// Accessor types that a use allows.
inline constexpr int kGltfScalar[] = {TINYGLTF_TYPE_SCALAR};
inline constexpr int kGltfVec3[] = {TINYGLTF_TYPE_VEC3};
inline constexpr int kGltfVec4[] = {TINYGLTF_TYPE_VEC4};

/// The purpose of an accessor, and the types and formats that glTF allows for it.
struct GltfUse {
  const char* name;                ///< for messages: "POSITION"
  std::span<const int> types;      ///< TINYGLTF_TYPE_...
  unsigned formats;                ///< set of the formats above
  unsigned quantized_formats = 0;  ///< formats that KHR_mesh_quantization adds
};

/// `count` elements of `components` floats each, one after the other.
struct GltfFloats {
  std::size_t count = 0, components = 0;
  std::vector<float> values;

  const float* operator[](std::size_t element) const { return values.data() + element * components; }
};

/// These functions throw InputError with the file, the accessor and its use, for a type or format that is not allowed,
/// bytes outside the buffer view or buffer, sparse indices that do not increase or are out of range, and values that
/// are not finite.
GltfFloats read_floats(const GltfDocument& document, int accessor, const GltfUse& use);
/// As read_floats(). Throws InputError as well if there is not one element for each of `vertices`.
GltfFloats read_vertex_floats(const GltfDocument& document, int accessor, const GltfUse& use, std::size_t vertices);
std::vector<std::uint32_t> read_integers(const GltfDocument& document, int accessor, const GltfUse& use);

/// Throws InputError like the readers for a type or format that is not allowed, but does not read the bytes.
void check_use(const GltfDocument& document, int accessor, const GltfUse& use);

/// Returns whether the file holds the accessor's data. An accessor without a buffer view holds only implied zeros, and
/// a file may leave out a buffer.
bool has_data(const GltfDocument& document, int accessor);

/// Checks for every accessor, used or not, that its bytes lie within the buffer. Throws InputError like the readers.
void check_accessors(const GltfDocument& document);

/// Returns the bytes of a buffer view. Throws InputError if they do not lie within the buffer; `place` names the user
/// of the buffer view in the message.
Bytes view_bytes(const GltfDocument& document, int buffer_view, const std::string& place);

}  // namespace simvis
