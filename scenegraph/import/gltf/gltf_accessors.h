// Reading accessors: every component type, normalised, strided and sparse, and never a byte outside its buffer view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scenegraph/import/gltf/gltf_document.h"

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

/// Types that a use allows.
inline constexpr int kGltfScalar[] = {TINYGLTF_TYPE_SCALAR};
inline constexpr int kGltfVec3[] = {TINYGLTF_TYPE_VEC3};
inline constexpr int kGltfVec4[] = {TINYGLTF_TYPE_VEC4};

/// What an accessor is read for, and what glTF allows there.
struct GltfUse {
  const char* name;                ///< for messages: "POSITION"
  std::span<const int> types;      ///< TINYGLTF_TYPE_...
  unsigned formats;                ///< set of the formats above
  unsigned quantized_formats = 0;  ///< those that KHR_mesh_quantization adds
};

/// `count` elements of `components` floats each, one after the other.
struct GltfFloats {
  std::size_t count = 0, components = 0;
  std::vector<float> values;

  const float* operator[](std::size_t element) const { return values.data() + element * components; }
};

/// Throw InputError naming the file, the accessor and its use: a type or format that is not allowed, bytes outside the
/// buffer view or buffer, sparse indices that do not increase or lie outside, a value that is not finite.
GltfFloats read_floats(const GltfDocument& document, int accessor, const GltfUse& use);
std::vector<std::uint32_t> read_integers(const GltfDocument& document, int accessor, const GltfUse& use);

/// Throws as they do for a type or format that is not allowed, without a look at the bytes.
void check_use(const GltfDocument& document, int accessor, const GltfUse& use);

/// Whether the file says what the accessor holds: without a buffer view it is zeros that nobody wrote, and a buffer may
/// be left out.
bool has_data(const GltfDocument& document, int accessor);

/// Checks that every accessor's bytes lie where they can be read, used or not. Throws InputError like the readers.
void check_accessors(const GltfDocument& document);

/// The bytes of a buffer view. Throws InputError when they do not lie within the buffer; `place` names who asks.
Bytes view_bytes(const GltfDocument& document, int buffer_view, const std::string& place);

}  // namespace simvis
