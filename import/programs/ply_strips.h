// Triangle strips of PLY files, as faces.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace simvis {

enum class PlyEncoding { text, little_endian, big_endian };

/// Assimp keeps one triangle of each strip, so strips are given to it as faces.
class PlyStrips {
 public:
  /// The next vertex of a strip. -1 ends the strip, and the next vertex begins another one.
  void add(std::int64_t vertex);

  /// Ends a strip: the next vertex begins another.
  void end_strip() { corners_ = 0; }

  /// The lines of the header that declare the faces.
  std::string header() const;

  /// The faces. Every second triangle of a strip is turned round; triangles with two equal corners, which only connect
  /// parts of a strip, are left out.
  std::string body(PlyEncoding encoding) const;

 private:
  using Triangle = std::array<std::uint32_t, 3>;

  std::vector<Triangle> triangles_;
  std::array<std::uint32_t, 2> last_{};
  std::size_t corners_ = 0;  // of the strip so far
};

}  // namespace simvis
