// Turns the <material> of an SDF visual into a material.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include "scenegraph/import/sdf/ogre_script.h"
#include "scenegraph/import/sdf/sdf_reader.h"

namespace simvis {

/// Colours are read as sRGB. In this order, the first that the file has gives the look:
///   <pbr><metal>       metalness, roughness, and the maps of albedo, normals, emission and ambient occlusion; the
///   colour
///                      is <diffuse>. Of <specular> only the maps that both have.
///   <diffuse>          with <emissive>
///   <script>           a plain colour of Gazebo, or an OGRE script's first pass: its diffuse colour and texture
///   <ambient>
/// A picture or script that is missing or broken gives a warning, and the colour remains.
class SdfMaterials {
 public:
  SdfMaterials(SdfFiles& files, SdfReport& report, ContentPool& pool) : files_(files), report_(report), pool_(pool) {}

  /// Null: the element says nothing about the look. Throws InputError for wrong numbers. `opacity` is a factor.
  std::shared_ptr<const Material> read(const SdfElement& material, const std::string& name, double opacity);
  /// The look of a shape without a material.
  static Material plain(double opacity);

 private:
  bool read_script(const SdfElement& script, Material& material);
  std::optional<OgreMaterial> find_script(const SdfElement& script, const std::string& name,
                                          std::filesystem::path& folder);
  void read_maps(const SdfElement& workflow, Material& material);
  std::shared_ptr<const Texture> map(const SdfElement& element);
  std::shared_ptr<const Texture> picture(const std::filesystem::path& file, const SdfElement& where);

  SdfFiles& files_;
  SdfReport& report_;
  ContentPool& pool_;
  std::map<std::filesystem::path, std::shared_ptr<const Texture>> pictures_;  // null: broken
};

}  // namespace simvis
