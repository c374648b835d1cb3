// Imports files of meshes, points and splats as scene graphs: COLLADA (.dae, .zae), Wavefront OBJ, PLY, STL, PCD, LAS,
// SPZ.
#pragma once

#include <filesystem>
#include <memory>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include <simvis/scene.h>

namespace simvis {

/// The up axis that the importer assumes for a mesh file.
enum class MeshFileAxes : std::uint8_t {
  of_format,  ///< COLLADA: its <up_axis>; SPZ: Y-up; OBJ, PLY and STL, which give none: Z-up
  y_up,
  as_written  ///< the axes of the file are the axes of the part, whatever its <up_axis> says
};

/// Decides by the file name extension, upper or lower case.
bool is_mesh_file(const std::filesystem::path& file);

/// Returns one separator that holds a separator for each node of the file, with the node's meshes. COLLADA's <unit> is
/// applied. Cameras and lights are not imported. Shapes without a material get `fallback`.
/// Throws InputError naming the file, and the place if known. A broken file never crashes the process. Throws
/// MachineError if the program simvis-import-mesh is missing.
PartContent read_mesh_file(const std::filesystem::path& file, MeshFileAxes axes,
                           std::shared_ptr<const Material> fallback, ContentPool& pool);

}  // namespace simvis
