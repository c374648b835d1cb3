// A glTF file in memory: its checked structure and its buffers.
#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "import/gltf/gltf_file.h"

namespace simvis {

/// The location of a picture file: a URI or a buffer view.
struct GltfImage {
  std::string name, uri;
  int buffer_view = -1;
};

/// An animation as the file describes it. The indices of accessors and nodes are valid; the reader must check the rest.
struct GltfAnimation {
  struct Channel {
    std::size_t sampler = 0;
    int node = -1;  ///< -1: none
    std::string path;
  };
  struct Sampler {
    int input = 0, output = 0;
    std::string interpolation;
  };
  std::string name;
  std::vector<Channel> channels;
  std::vector<Sampler> samplers;
};

/// The key under which a primitive's indices are stored among its attributes. tinygltf 2.7 refuses indices without a
/// buffer view, which glTF allows, so the indices are hidden from it. No attribute name begins like this.
inline constexpr const char* kGltfIndices = "(indices)";

/// Every index in `model` is valid and every number is in its range. The readers check the contents of the bytes.
/// tinygltf receives only the checked structure; `model` has no buffers, images, cameras or animations.
struct GltfDocument {
  std::filesystem::path file;
  tinygltf::Model model;
  std::vector<GltfBuffer> buffers;  ///< byteLength bytes each; empty if the file leaves the buffer out
  std::vector<GltfImage> images;
  std::vector<GltfAnimation> animations;
  std::vector<std::string> warnings;
  std::uint64_t structure_hash = 0;  ///< of the JSON text

  /// Throws InputError "FILE: error: WHAT".
  [[noreturn]] void fail(const std::string& what) const;
  /// Adds "FILE: WHAT", once.
  void warn(const std::string& what);
  /// Adds a warning that names its file already, once.
  void add_warning(std::string warning);
  bool uses(std::string_view extension) const;
};

/// Reads the structure and opens the buffers; check_accessors() checks that the buffers hold what it names. Without
/// `buffers`, these stay closed and have no bytes, but their files must be there. Throws InputError naming the file.
GltfDocument read_gltf_document(const std::filesystem::path& file, bool buffers = true);
/// The same of a document that another format has become, with the bytes of its first buffer. `file` is for messages.
GltfDocument read_converted_gltf(const std::filesystem::path& file, std::string_view text, Bytes binary);

}  // namespace simvis
