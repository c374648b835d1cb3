// Mesh files as scene graphs: COLLADA (.dae), Wavefront OBJ, PLY, STL.
#pragma once

#include <filesystem>
#include <memory>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include <simvis/scene.h>

namespace simvis {

/// Which way up a mesh file is taken.
enum class MeshFileAxes : std::uint8_t {
  of_format,  ///< COLLADA by its <up_axis>; OBJ, PLY and STL, which do not say, are Z-up
  y_up,
  as_written  ///< whatever the file says: its axes are those of the part
};

/// By its ending, in any case.
bool is_mesh_file(const std::filesystem::path& file);

/// Everything under one separator: a separator per node of the file, each with its meshes. COLLADA's <unit> counts.
/// Cameras and lights of a file are not taken. `fallback` is the material of whatever has none of its own.
/// Throws InputError naming the file, and a place where there is one; never crashes on a broken file. Throws
/// MachineError when the program simvis-import-mesh is missing.
PartContent read_mesh_file(const std::filesystem::path& file, MeshFileAxes axes,
                           std::shared_ptr<const Material> fallback, ContentPool& pool);

}  // namespace simvis
