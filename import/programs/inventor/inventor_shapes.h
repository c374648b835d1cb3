// Makes meshes from the primitives that Coin generates for shapes.
#pragma once

#include <Inventor/SoPrimitiveVertex.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/details/SoPointDetail.h>
#include <Inventor/nodes/SoShape.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include <simvis/content_pool.h>
#include "import/programs/inventor/inventor_look.h"
#include "import/sandbox/imported_scene.h"

namespace simvis {

glm::dmat4 matrix_of(const SbMatrix& matrix);
/// Returns the name of the innermost named node on the path to the current node.
std::string innermost_name(const SoCallbackAction& action);

class InventorShapes {
 public:
  /// The largest number of corners in one file: 10 million triangles.
  static constexpr std::size_t kMaxCorners = 30'000'000;

  explicit InventorShapes(ImportedScene& scene) : scene_(scene), looks_(scene) {}

  void begin(const SoCallbackAction& action, const SoShape& shape);
  void triangle(SoCallbackAction& action, const SoPrimitiveVertex* const (&corners)[3]);
  void line(SoCallbackAction& action, const SoPrimitiveVertex* const (&ends)[2]);
  void point(SoCallbackAction& action, const SoPrimitiveVertex& vertex);
  void end(SoCallbackAction& action);

  bool has_too_many() const { return corners_ > kMaxCorners; }
  /// The first error in the shapes so far; empty if there is none.
  const std::string& fault() const { return fault_; }

 private:
  struct Vertex {
    glm::vec3 position;
    VertexAttributes attributes;
  };
  struct SameBits {
    bool operator()(const Vertex& a, const Vertex& b) const;
  };
  struct HashBits {
    std::size_t operator()(const Vertex& vertex) const;
  };
  // The triangles, lines or points of the current shape so far.
  struct Growing {
    Mesh mesh;
    std::unordered_map<Vertex, std::uint32_t, HashBits, SameBits> known;
  };

  bool starts_primitive(SoCallbackAction& action, std::size_t corners);
  void read_state(SoCallbackAction& action, bool is_surface);
  void check_largest_index(const SoShape& shape, int count);
  void check_index(int index, int count, const char* what);
  void check_indices(const SoPointDetail& detail);
  void check_indices(const SoDetail* detail);
  Vertex vertex_of(SoCallbackAction& action, const SoPrimitiveVertex& source);
  void add(Growing& growing, const Vertex& vertex);
  void finish(SoCallbackAction& action, Growing& growing);
  std::uint32_t number_of(Mesh&& mesh);

  ImportedScene& scene_;
  InventorLooks looks_;
  const SoShape* shape_ = nullptr;
  std::optional<InventorLook> look_;  // of the current shape, set at its first primitive
  bool clockwise_ = false, ordering_known_ = false;
  SoDrawStyle::Style style_ = SoDrawStyle::FILLED;
  int coordinates_ = 0, normals_ = 0, uvs_ = 0;  // counts in the state, for shapes made of vertices
  bool has_uvs_ = true;                          // for the current primitive, if it is textured
  std::string fault_;
  std::unordered_map<int, glm::vec4> colors_;
  Growing growing_[3];  // indexed by Topology
  std::size_t corners_ = 0;
  ContentPool pool_;
  std::map<const Mesh*, std::uint32_t> numbers_;
  std::vector<std::shared_ptr<const Mesh>> kept_;
};

}  // namespace simvis
