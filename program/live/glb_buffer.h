// The binary chunk of a GLB with its views and accessors.
#pragma once

#include <cstring>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace simvis::live {

class GlbBuffer {
 public:
  using Json = nlohmann::ordered_json;
  enum class Use : int { image = 0, vertices = 34962, indices = 34963 };  // as in OpenGL; images have none

  /// Returns the index of the view.
  std::size_t add_view(std::string_view bytes, Use use) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
    if (use != Use::image) view["target"] = static_cast<int>(use);
    views_.push_back(std::move(view));
    bytes_.append(bytes);
    return views_.size() - 1;
  }

  /// Returns the index of the accessor. `values` is not empty.
  template <typename T>
  std::size_t add(std::span<const T> values, Use use, int component, const char* type) {
    const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    accessors_.push_back(
        {{"bufferView", add_view(bytes, use)}, {"componentType", component}, {"count", values.size()}, {"type", type}});
    return accessors_.size() - 1;
  }

  Json& accessor(std::size_t index) { return accessors_[index]; }

  /// Moves what is here into the file's JSON, and returns the bytes of the chunk.
  std::string take(Json& gltf) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    if (bytes_.empty()) return {};
    gltf["accessors"] = std::move(accessors_);
    gltf["bufferViews"] = std::move(views_);
    gltf["buffers"] = {{{"byteLength", bytes_.size()}}};
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
  Json views_ = Json::array(), accessors_ = Json::array();
};

}  // namespace simvis::live
