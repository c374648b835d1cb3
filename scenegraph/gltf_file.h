// From a .gltf or .glb file to its JSON text and its bytes: containers, URIs, data URIs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace simvis {

using Bytes = std::vector<std::uint8_t>;

/// The two chunks of a .glb, or the text of a .gltf. Both views lie in the bytes that were split.
struct GltfChunks {
  std::string_view json;
  std::span<const std::uint8_t> binary;
  bool has_binary = false;
  std::size_t extra_bytes = 0;  ///< after the end that the .glb gives for itself
};

/// Reads a regular file whole. Throws InputError naming it and the operating system's reason.
Bytes read_whole_file(const std::filesystem::path& file);

/// Throws InputError naming `file`: not glTF 2 binary, lengths that do not fit each other or the file.
GltfChunks split_gltf(std::span<const std::uint8_t> bytes, const std::filesystem::path& file);

/// The bytes behind a URI of the glTF `file`: a base64 data URI, or a relative path at or below the file's folder,
/// percent-encoded or not. Throws InputError naming `file`, `place` (such as "buffers/0") and what is wrong.
Bytes read_gltf_uri(std::string_view uri, const std::filesystem::path& file, const std::string& place);

}  // namespace simvis
