// Reads the JSON text and the bytes of a .gltf or .glb file: containers, URIs and data URIs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/input_file.h"

namespace simvis {

/// The bytes of a glTF buffer, in memory or in a file. Bytes in a file are read on request, so that the whole buffer
/// and the meshes made from it need not be in memory at the same time.
class GltfBuffer {
 public:
  GltfBuffer() = default;
  explicit GltfBuffer(Bytes bytes) : bytes_(std::move(bytes)), size_(bytes_.size()) {}
  GltfBuffer(std::shared_ptr<const InputFile> file, std::size_t first, std::size_t size)
      : file_(std::move(file)), first_(first), size_(size) {}

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  std::size_t bytes_held() const { return bytes_.size(); }

  /// Keeps the first `size` bytes. `size` is at most size().
  void cut(std::size_t size);

  /// Returns `count` bytes from `first` on, which must lie within the buffer. Throws InputError as InputFile::read().
  Bytes read(std::size_t first, std::size_t count) const;

 private:
  Bytes bytes_;
  std::shared_ptr<const InputFile> file_;  // null: the bytes are in bytes_
  std::size_t first_ = 0, size_ = 0;
};

/// The two chunks of a .glb, or the text of a .gltf.
struct GltfChunks {
  Bytes json;
  std::size_t binary_first = 0, binary_size = 0;  ///< position of the binary chunk in the file, in bytes
  bool has_binary = false;

  std::string_view text() const { return {reinterpret_cast<const char*>(json.data()), json.size()}; }
  std::size_t extra_bytes = 0;  ///< after the end that the .glb header gives
};

/// Splits `input`, which is the open file `file`. Throws InputError naming `file` if it is not glTF 2 binary or if its
/// lengths do not fit each other or the file.
GltfChunks split_gltf(const InputFile& input, const std::filesystem::path& file);

/// The path of a relative URI, from the folder of the glTF `file`. It may be read (read_fence.h). Throws InputError
/// with `file`, `place` (such as "buffers/0") and the reason.
std::filesystem::path relative_gltf_path(std::string_view uri, const std::filesystem::path& file,
                                         const std::string& place);

/// Opens a URI of the glTF `file`: a base64 data URI, or a relative path as of relative_gltf_path(), percent-encoded or
/// not. Throws InputError with `file`, `place` (such as "buffers/0") and the reason.
GltfBuffer open_gltf_uri(std::string_view uri, const std::filesystem::path& file, const std::string& place);

}  // namespace simvis
