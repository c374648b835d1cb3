#include "import/programs/assimp_import.h"

#include <assimp/config.h>
#include <strings.h>

#include <exception>
#include <new>
#include <sstream>
#include <string>

#include <simvis/location.h>
#include "import/programs/collada/collada_archive.h"
#include "import/programs/collada/collada_check.h"
#include "import/programs/collada/collada_opacity.h"
#include "import/programs/collada/collada_pictures.h"
#include "import/programs/collada/collada_references.h"
#include "import/programs/collada/collada_shapes.h"
#include "import/programs/collada/collada_text.h"
#include "import/programs/collada/collada_uv_sets.h"
#include "scenegraph/language/control_characters.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {
namespace {

// Assimp may repeat the rest of the file in an error.
std::string shortened(std::string error) {
  constexpr std::size_t kLongestError = 300;
  if (error.size() > kLongestError) error = error.substr(0, kLongestError) + "...";
  return error;
}

// Returns the XML that Assimp reads in place of the file.
std::string prepared_collada(AssimpFile& read) {
  XmlText text(read_collada_text(read));
  repair_collada_references(text, read);
  check_collada(text);
  replace_skews(text);
  set_collada_opacities(text, read);
  remove_collada_textures_without_file(text, read);
  const ColladaShapes shapes = reduce_to_shapes(text);
  if (shapes.had_animations) read.warn("animations are not played; the rest pose is imported");
  if (shapes.had_skins) read.warn("skins are not animated; skinned meshes are imported in their rest pose");
  set_collada_uv_sets(text, read);
  std::ostringstream xml;
  text.document().save(xml, "", pugi::format_raw);
  return xml.str();
}

void check_indices(const AssimpFile& read) {
  const aiScene& scene = *read.scene;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& mesh = *scene.mMeshes[m];
    if (mesh.mMaterialIndex >= scene.mNumMaterials) read.fail("a mesh has a material that is not in the file");
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      for (unsigned i = 0; i < mesh.mFaces[f].mNumIndices; ++i) {
        if (mesh.mFaces[f].mIndices[i] >= mesh.mNumVertices) read.fail("a face has a vertex that is not in the file");
      }
    }
  }
}

// Assimp turns every exception into a text. This function throws std::bad_alloc again.
void throw_if_memory_ran_out(const Assimp::Importer& importer) {
  if (!importer.GetException()) return;
  try {
    std::rethrow_exception(importer.GetException());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (...) {
  }
}

}  // namespace

AssimpFile read_assimp_file(const std::filesystem::path& file, bool ignore_up_axis) {
  AssimpFile read;
  read.file = file;
  read.importer = std::make_unique<Assimp::Importer>();
  read.check_size();
  if (::strcasecmp(file.extension().c_str(), ".zae") == 0) {
    read.archive = std::make_shared<const ColladaArchive>(file, read_whole_file(file));
    read.bytes = read.archive->document();
  }
  read.importer->SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  read.importer->SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, ignore_up_axis);
  read.importer->SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);
  // Assimp's post-processing steps are off: its triangulation of a polygon has overlaps, and its vertex merging also
  // merges vertices that are only near each other.
  constexpr unsigned kNoSteps = 0;
  const std::string xml = prepared_collada(read);
  read.scene = read.importer->ReadFileFromMemory(xml.data(), xml.size(), kNoSteps, "dae");
  throw_if_memory_ran_out(*read.importer);
  const std::string reason = shortened(on_one_line(read.importer->GetErrorString()));
  if (read.scene == nullptr) read.fail(reason.empty() ? "is refused by Assimp, which gives no reason" : reason);
  if (read.scene->mRootNode == nullptr) read.fail("holds nothing to draw");
  check_indices(read);
  return read;
}

}  // namespace simvis
