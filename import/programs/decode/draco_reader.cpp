#include "import/programs/decode/draco_reader.h"

#include <draco/compression/decode.h>

#include <string>
#include <utility>

#include <simvis/error.h>

namespace simvis {
namespace {

template <class T>
bool convert(const draco::PointAttribute& source, std::uint64_t vertices, std::uint32_t components,
             std::vector<std::uint8_t>& bytes) {
  std::vector<T> value(components);
  bytes.reserve(vertices * components * sizeof(T));
  for (std::uint64_t i = 0; i < vertices; ++i) {
    const draco::AttributeValueIndex index = source.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (index.value() >= source.size()) return false;
    if (!source.ConvertValue<T>(index, static_cast<std::int8_t>(components), value.data())) return false;
    const auto* const first = reinterpret_cast<const std::uint8_t*>(value.data());
    bytes.insert(bytes.end(), first, first + components * sizeof(T));
  }
  return true;
}

bool convert(const draco::PointAttribute& source, std::uint64_t vertices, const DracoAttribute& attribute,
             std::vector<std::uint8_t>& bytes) {
  switch (attribute.component_type) {
    case 5120:
      return convert<std::int8_t>(source, vertices, attribute.components, bytes);
    case 5121:
      return convert<std::uint8_t>(source, vertices, attribute.components, bytes);
    case 5122:
      return convert<std::int16_t>(source, vertices, attribute.components, bytes);
    case 5123:
      return convert<std::uint16_t>(source, vertices, attribute.components, bytes);
    case 5125:
      return convert<std::uint32_t>(source, vertices, attribute.components, bytes);
    case 5126:
      return convert<float>(source, vertices, attribute.components, bytes);
    default:
      return false;
  }
}

/// Symbols that are as expected take almost no bits, so the size of the data does not limit how much they stand for: a
/// flat grid has 600 triangles in a byte. Other meshes have some; small ones may be as regular as they like.
void require_plausible(const draco::Mesh& mesh, std::size_t bytes) {
  constexpr std::size_t kMaxElementsPerByte = 64, kMaxElementsWithoutBytes = std::size_t{1} << 20;
  const std::size_t most = kMaxElementsWithoutBytes + kMaxElementsPerByte * bytes;
  if (mesh.num_points() <= most && mesh.num_faces() <= most) return;
  throw InputError("gives " + std::to_string(mesh.num_points()) + " vertices and " + std::to_string(mesh.num_faces()) +
                   " triangles, more than its " + std::to_string(bytes) + " bytes can hold");
}

}  // namespace

DracoMesh read_draco(std::span<const std::uint8_t> bytes, std::span<const DracoAttribute> attributes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw InputError("is broken Draco data: " + decoded.status().error_msg_string());
  const std::unique_ptr<draco::Mesh> source = std::move(decoded).value();
  require_plausible(*source, bytes.size());
  DracoMesh mesh;
  mesh.vertices = source->num_points();
  mesh.indices.reserve(std::size_t{3} * source->num_faces());
  for (draco::FaceIndex f(0); f < source->num_faces(); ++f) {
    for (const draco::PointIndex& corner : source->face(f)) mesh.indices.push_back(corner.value());
  }
  for (const DracoAttribute& attribute : attributes) {
    const draco::PointAttribute* const found = source->GetAttributeByUniqueId(attribute.id);
    const std::string subject = "attribute " + std::to_string(attribute.id);
    if (found == nullptr) throw InputError("lacks " + subject);
    if (found->num_components() != static_cast<int>(attribute.components)) {
      throw InputError("has " + std::to_string(found->num_components()) + " components in " + subject + "; expected " +
                       std::to_string(attribute.components));
    }
    if (!convert(*found, mesh.vertices, attribute, mesh.attributes.emplace_back())) {
      throw InputError("has values in " + subject + " that do not fit the accessor's componentType");
    }
  }
  return mesh;
}

}  // namespace simvis
