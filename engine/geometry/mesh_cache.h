// Results of long computations on a mesh, kept on disk between runs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include <simvis/mesh.h>

namespace simvis {

/// Meshes with fewer triangles are not cached, because everything is computed from them in a few milliseconds.
inline constexpr std::size_t kMinCachedTriangles = 1u << 13;

/// A file that is named by the kind of its content and by the mesh's positions and indices. A file that is missing,
/// truncated, damaged or of another version reads as empty. A folder that cannot be written is no error.
class MeshCacheFile {
 public:
  /// `folder` is not empty. `kind` names the content. `version`, a printable character, identifies the file format and
  /// the computation.
  MeshCacheFile(const std::filesystem::path& folder, std::string_view kind, char version, const Mesh& mesh);

  /// The content written for an equal mesh; else empty.
  std::vector<std::uint32_t> read() const;

  void write(std::span<const std::uint32_t> words) const;

 private:
  struct Header {
    std::array<char, 8> magic{};
    std::array<std::uint64_t, 2> key{};  // 128 bits, so that no two meshes share a name by chance
    std::uint64_t words = 0, checksum = 0;

    bool operator==(const Header&) const = default;
  };
  static_assert(sizeof(Header) == 40, "no padding");
  Header header_for(std::span<const std::uint32_t> words) const;

  std::array<char, 8> magic_;
  std::array<std::uint64_t, 2> key_;
  std::filesystem::path file_;
};

}  // namespace simvis
