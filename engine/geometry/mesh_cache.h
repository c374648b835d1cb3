// What takes long to work out of a mesh, kept on disk between runs.
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

/// Of meshes with fewer triangles all is made in a few milliseconds.
inline constexpr std::size_t kMinCachedTriangles = 1u << 13;

/// A file that is named by what it holds and by what the mesh holds, its positions and indices. One that is missing,
/// cut off or damaged, or that is of another version, reads as nothing; a folder that cannot be written is no error.
class MeshCacheFile {
 public:
  /// `folder` is not empty. `kind` is what it holds. `version`, a printable character, counts how that is written and
  /// made of a mesh.
  MeshCacheFile(const std::filesystem::path& folder, std::string_view kind, char version, const Mesh& mesh);

  /// What was written for such a mesh; else empty.
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
