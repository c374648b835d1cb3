#include "bench/scenes/finer_part.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/scenes/glb_file.h"

namespace simvis::bench {

namespace {

using Json = nlohmann::json;

constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123;
constexpr std::size_t kManyTriangles = 2000;

std::size_t components_of(const Json& accessor) {
  const std::string type = accessor.at("type");
  return type == "SCALAR" ? 1 : static_cast<std::size_t>(type.at(3) - '0');
}

/// The values of an accessor, tightly packed.
template <typename T>
std::vector<T> values_of(const GlbDocument& document, const Json& accessor) {
  const Json& view = document.json.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  if (view.contains("byteStride")) throw std::runtime_error("an accessor with a stride");
  std::vector<T> values(accessor.at("count").get<std::size_t>() * components_of(accessor));
  const std::size_t first = view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  std::memcpy(values.data(), document.buffer.data() + first, values.size() * sizeof(T));
  return values;
}

std::vector<std::uint32_t> indices_of(const GlbDocument& document, const Json& accessor) {
  if (accessor.at("componentType") == kUnsignedInt) return values_of<std::uint32_t>(document, accessor);
  if (accessor.at("componentType") != kUnsignedShort) throw std::runtime_error("indices of an unknown type");
  const std::vector<std::uint16_t> narrow = values_of<std::uint16_t>(document, accessor);
  return {narrow.begin(), narrow.end()};
}

/// The weights of the vertices of a subdivided triangle, row by row; they sum to `parts`.
std::vector<glm::ivec3> weights_of(int parts) {
  std::vector<glm::ivec3> weights;
  for (int row = 0; row <= parts; ++row) {
    for (int column = 0; column <= parts - row; ++column) weights.emplace_back(parts - row - column, column, row);
  }
  return weights;
}

std::vector<std::uint32_t> cut_indices(std::size_t triangles, int parts) {
  const std::size_t vertices = weights_of(parts).size();
  std::vector<std::uint32_t> indices;
  for (std::size_t t = 0; t < triangles; ++t) {
    auto row_start = static_cast<std::uint32_t>(t * vertices);
    for (int row = 0; row < parts; ++row) {
      const auto length = static_cast<std::uint32_t>(parts - row + 1);
      for (std::uint32_t i = 0; i + 1 < length; ++i) {
        const std::uint32_t here = row_start + i, above = here + length;
        indices.insert(indices.end(), {here, here + 1, above});
        if (i + 2 < length) indices.insert(indices.end(), {here + 1, above + 1, above});
      }
      row_start += length;
    }
  }
  return indices;
}

/// One attribute at the vertices of all subdivided triangles. Weights are integers and sums are in double: an edge gets
/// the same values from both of its sides.
std::vector<float> cut_values(const std::vector<float>& values, std::size_t components,
                              const std::vector<std::uint32_t>& indices, int parts) {
  const std::vector<glm::ivec3> weights = weights_of(parts);
  std::vector<float> cut;
  cut.reserve(indices.size() / 3 * weights.size() * components);
  for (std::size_t t = 0; t < indices.size(); t += 3) {
    for (const glm::ivec3& weight : weights) {
      for (std::size_t c = 0; c < components; ++c) {
        double sum = 0;
        for (int corner = 0; corner < 3; ++corner) {
          sum += double{values[indices[t + static_cast<std::size_t>(corner)] * components + c]} * weight[corner];
        }
        cut.push_back(static_cast<float>(sum / parts));
      }
    }
  }
  return cut;
}

std::size_t add_accessor(GlbDocument& document, const Json& like, const void* data, std::size_t bytes,
                         std::size_t count, int component) {
  Json accessor = {{"bufferView", document.add_view(data, bytes)},
                   {"componentType", component},
                   {"type", like.at("type")},
                   {"count", count}};
  document.json["accessors"].push_back(std::move(accessor));
  return document.json["accessors"].size() - 1;
}

void set_bounds(Json& accessor, const std::vector<float>& positions) {
  std::vector<float> low(3, std::numeric_limits<float>::infinity()), high(3, -low[0]);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], positions[i]);
    high[i % 3] = std::max(high[i % 3], positions[i]);
  }
  accessor["min"] = low;
  accessor["max"] = high;
}

void cut(GlbDocument& document, Json& primitive, int parts) {
  const Json accessors = document.json.at("accessors");
  const Json& old_indices = accessors.at(primitive.at("indices").get<std::size_t>());
  const std::vector<std::uint32_t> indices = indices_of(document, old_indices);
  for (auto& [name, number] : primitive.at("attributes").items()) {
    const Json& old = accessors.at(number.get<std::size_t>());
    if (old.at("componentType") != kFloat) throw std::runtime_error("an attribute that is no float");
    const std::size_t components = components_of(old);
    const std::vector<float> values = cut_values(values_of<float>(document, old), components, indices, parts);
    const std::size_t added =
        add_accessor(document, old, values.data(), values.size() * sizeof(float), values.size() / components, kFloat);
    if (name == "POSITION") set_bounds(document.json["accessors"][added], values);
    number = added;
  }
  const std::vector<std::uint32_t> cut = cut_indices(indices.size() / 3, parts);
  primitive["indices"] =
      add_accessor(document, old_indices, cut.data(), cut.size() * sizeof(std::uint32_t), cut.size(), kUnsignedInt);
}

std::size_t triangles_of(const GlbDocument& document) {
  std::size_t indices = 0;
  for (const Json& mesh : document.json.at("meshes")) {
    for (const Json& primitive : mesh.at("primitives")) {
      indices +=
          document.json.at("accessors").at(primitive.at("indices").get<std::size_t>()).at("count").get<std::size_t>();
    }
  }
  return indices / 3;
}

}  // namespace

void write_finer_part(const std::filesystem::path& from, const std::filesystem::path& to, int parts) {
  GlbDocument document = read_glb(from);
  Json meshes = document.json.at("meshes");
  for (Json& mesh : meshes) {
    for (Json& primitive : mesh.at("primitives")) cut(document, primitive, parts);
  }
  document.json["meshes"] = std::move(meshes);
  write_glb(to, std::move(document));
}

std::filesystem::path write_finer_marvin(const std::filesystem::path& folder) {
  const std::filesystem::path marvin = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin";
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(marvin)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() == ".glb") {
      const bool many = triangles_of(read_glb(file)) > kManyTriangles;
      write_finer_part(file, folder / file.filename(), many ? 4 : 3);
    } else if (file.extension() == ".xml" || file.extension() == ".csv") {
      std::filesystem::copy_file(file, folder / file.filename(), std::filesystem::copy_options::overwrite_existing);
    }
  }
  return folder / "marvin.xml";
}

}  // namespace simvis::bench
