#include "import/model/model_meshes.h"

#include <strings.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include <simvis/error.h>
#include <simvis/part_importer.h>
#include "engine/base/read_fence.h"

namespace simvis {
namespace {

bool is_gltf(const std::filesystem::path& file) {
  return ::strcasecmp(file.extension().c_str(), ".gltf") == 0 || ::strcasecmp(file.extension().c_str(), ".glb") == 0;
}

}  // namespace

bool ModelMeshes::is_known(const std::filesystem::path& file) { return is_gltf(file) || is_mesh_file(file); }

GroupPtr ModelMeshes::read(const std::filesystem::path& file, MeshFileAxes axes,
                           const std::shared_ptr<const Material>& fallback, ContentPool& pool) {
  require_readable(file);
  const bool has_own_default = is_gltf(file);
  const UpAxis up = axes == MeshFileAxes::y_up ? UpAxis::y : UpAxis::z;
  const auto [known, is_new] = read_.try_emplace({file, axes, has_own_default ? nullptr : fallback});
  MeshContent& read = known->second;
  if (is_new) {
    try {
      PartContent content = has_own_default ? find_part_importer(file)({.file = file, .up_given = true, .up = up}, pool)
                                            : read_mesh_file(file, axes, fallback, pool);
      read.root = std::static_pointer_cast<Group>(content.root);
      std::ranges::move(content.warnings, std::back_inserter(warnings_));
    } catch (const InputError& error) {
      read.error = error.what();
    }
  }
  if (read.root == nullptr) throw InputError(read.error);
  return read.root;
}

GroupPtr ModelMeshes::surface(const std::filesystem::path& file, ContentPool& pool) {
  constexpr MeshFileAxes kAxes = MeshFileAxes::as_written;
  const auto first = read_.lower_bound({file, kAxes, nullptr});
  const bool is_read = first != read_.end() && std::get<0>(first->first) == file && std::get<1>(first->first) == kAxes;
  return read(file, kAxes, is_read ? std::get<2>(first->first) : std::make_shared<const Material>(), pool);
}

}  // namespace simvis
