#include "import/mjcf/mjcf_mesh_data.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <simvis/error.h>
#include "engine/base/binary_numbers.h"
#include "engine/base/input_file.h"
#include "import/mesh/convex_hull.h"

namespace simvis {
namespace {

constexpr std::size_t kMaxMjcfNumbers = 30'000'000;  // of an attribute

// Triangles that share no vertex, each with its own normal. One without area has that of z.
Mesh flat_mesh(const Mesh& shared) {
  Mesh mesh;
  for (std::size_t i = 0; i + 2 < shared.indices.size(); i += 3) {
    const auto place = [&](std::size_t corner) { return glm::dvec3(shared.positions[shared.indices[i + corner]]); };
    const glm::dvec3 across = glm::cross(place(1) - place(0), place(2) - place(0));
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = shared.indices[i + corner];
      VertexAttributes attributes = shared.attributes[vertex];
      if (glm::length(across) > 0) attributes.normal = glm::vec3(glm::normalize(across));
      mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(shared.positions[vertex]);
      mesh.attributes.push_back(attributes);
    }
  }
  compute_bounds(mesh);
  return mesh;
}

[[noreturn]] void fail_msh(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": error: " + what);
}

// Reads values of 32 bits one after the other. The caller has checked that they are there.
class MshReader {
 public:
  explicit MshReader(const Bytes& bytes) : bytes_(bytes) {}
  template <typename Value>
  Value next() {
    static_assert(sizeof(Value) == 4);
    return binary_at<Value>(bytes_, std::exchange(at_, at_ + sizeof(Value)));
  }
  glm::vec3 vector() {
    const float x = next<float>(), y = next<float>(), z = next<float>();
    return {x, y, z};
  }

 private:
  const Bytes& bytes_;
  std::size_t at_ = 0;
};

}  // namespace

Mesh mjcf_hull(const MjcfElement& asset, std::vector<glm::vec3> vertices) {
  const std::vector<glm::dvec3> points(vertices.begin(), vertices.end());
  const auto hull = convex_hull(points);
  if (!hull) {
    asset.fail("has no \"face\", and the convex hull of its " + std::to_string(points.size()) +
               " vertices takes too long, expected fewer or faces");
  }
  if (hull->empty()) asset.fail("has no \"face\", and vertices that lie in one plane");
  Mesh mesh;
  mesh.positions = std::move(vertices);
  mesh.attributes.resize(mesh.positions.size());
  mesh.indices = *hull;
  return flat_mesh(mesh);
}

Mesh inline_mjcf_mesh(const MjcfElement& asset) {
  const std::vector<double> numbers = asset.numbers("vertex", 9, kMaxMjcfNumbers),
                            faces = asset.numbers("face", 3, kMaxMjcfNumbers);
  if (numbers.size() % 3 != 0 || faces.size() % 3 != 0) asset.fail("has vertices or faces that are no triples");
  Mesh mesh;
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    mesh.positions.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
  mesh.attributes.resize(mesh.positions.size());
  for (const double face : faces) {
    if (!(face >= 0 && face < static_cast<double>(mesh.positions.size()) && face == std::floor(face))) {
      asset.fail("has a face of a vertex that is not there");
    }
    mesh.indices.push_back(static_cast<std::uint32_t>(face));
  }
  if (faces.empty()) return mjcf_hull(asset, std::move(mesh.positions));
  return flat_mesh(mesh);
}

Mesh read_msh_file(const std::filesystem::path& file) {
  const Bytes bytes = read_whole_file(file);
  constexpr std::size_t kHeader = 16, kWord = 4;
  if (bytes.size() < kHeader) fail_msh(file, "ends within its header, expected a mesh of MuJoCo");
  MshReader reader(bytes);
  std::array<std::size_t, 4> counts{};
  for (std::size_t& count : counts) count = reader.next<std::uint32_t>();
  const auto [vertices, normals, coordinates, triangles] = counts;
  const std::size_t words = 3 * vertices + 3 * normals + 2 * coordinates + 3 * triangles;
  const bool fits = (normals == 0 || normals == vertices) && (coordinates == 0 || coordinates == vertices);
  if (!fits || bytes.size() != kHeader + kWord * words) {
    fail_msh(file, "has another size than its header says, expected a mesh of MuJoCo");
  }
  Mesh mesh;
  for (std::size_t i = 0; i < vertices; ++i) {
    mesh.positions.push_back(reader.vector());
    const glm::vec3& p = mesh.positions.back();
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      fail_msh(file, "has a position that is not finite");
    }
  }
  mesh.attributes.resize(vertices);
  for (std::size_t i = 0; i < normals; ++i) {
    const glm::vec3 normal = reader.vector();
    const float length = glm::length(normal);
    if (std::isfinite(length) && length > 0) mesh.attributes[i].normal = normal / length;
  }
  for (std::size_t i = 0; i < coordinates; ++i) {
    const float u = reader.next<float>(), v = reader.next<float>();
    if (std::isfinite(u) && std::isfinite(v)) mesh.attributes[i].uv[0] = mesh.attributes[i].uv[1] = {u, v};
  }
  for (std::size_t i = 0; i < 3 * triangles; ++i) {
    mesh.indices.push_back(reader.next<std::uint32_t>());
    if (mesh.indices.back() >= vertices) fail_msh(file, "has a triangle of a vertex that is not there");
  }
  if (normals == 0) mesh = flat_mesh(mesh);
  compute_bounds(mesh);
  return mesh;
}

}  // namespace simvis
