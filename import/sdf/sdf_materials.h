// Turns the <material> of an SDF visual into a material.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include "import/sdf/ogre_script.h"
#include "import/sdf/sdf_reader.h"

namespace simvis {

/// Colours are read as sRGB. In this order, the first that the file has gives the look:
///   <pbr><metal>       metalness, roughness, and the maps of albedo, normals, emission and ambient occlusion;
///                      the colour is <diffuse>. Of <specular> only the maps that both have.
///   <diffuse>          with <emissive>
///   <script>           a plain colour of Gazebo, or an OGRE script's first pass: its diffuse colour and texture
///   <ambient>
/// A picture or script that is missing or broken gives a warning, and the colour remains.
class SdfMaterials {
 public:
  SdfMaterials(SdfFiles& files, ImportReport& report, ContentPool& pool)
      : files_(files), report_(report), pool_(pool) {}

  /// Null: the element says nothing about the look. Throws InputError for wrong numbers. `opacity` is a factor.
  std::shared_ptr<const Material> read(const SdfElement& material, const std::string& name, double opacity);
  /// The look of a heightmap with the first <texture>, which repeats every <size> metres.
  std::shared_ptr<const Material> of_heightmap(const SdfElement& texture, const glm::dvec2& size_m, double opacity);
  /// The look of a shape without a material.
  static Material plain(double opacity);

 private:
  bool read_script(const SdfElement& script, Material& material);
  std::optional<OgreMaterial> find_script(const SdfElement& script, const std::string& name,
                                          std::filesystem::path& folder);
  void read_maps(const SdfElement& workflow, Material& material);
  // What a picture is for, and the look of its material without it.
  struct Look {
    PictureUse use = PictureUse::color;
    std::function<void(Material&)> without{};
  };
  static Look look_of(const Material& material);
  std::shared_ptr<const Texture> map(const SdfElement& element, Look look);
  std::shared_ptr<const Texture> picture(const std::filesystem::path& file, const SdfElement& where, Look look);

  SdfFiles& files_;
  ImportReport& report_;
  ContentPool& pool_;
  std::map<std::pair<std::filesystem::path, PictureUse>, std::shared_ptr<const Texture>> pictures_;  // null: broken
};

}  // namespace simvis
