#include "scenegraph/import/helper/assimp_file.h"

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <simvis/location.h>
#include "engine/base/input_log.h"
#include "scenegraph/import/helper/collada_check.h"
#include "scenegraph/import/helper/collada_shapes.h"
#include "scenegraph/import/helper/ply_check.h"
#include "scenegraph/import/helper/stl_check.h"
#include "scenegraph/language/xml_text.h"

namespace simvis {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;

std::string lower_case_ending(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return ending;
}

// Assimp 5.2 dereferences a null pointer if a material file sets a property before it names a material.
void check_mtl(const char* file) {
  std::ifstream stream(file);
  std::string word;
  while (stream >> word && word.starts_with('#')) std::getline(stream, word);
  if (stream && word != "newmtl") {
    throw std::runtime_error(std::string(file) + ": begins with " + in_quotes(word) + ", expected \"newmtl\"");
  }
}

// Opens regular files only and records the names of missing files, because Assimp skips a missing material file without
// a message. All files that an OBJ file opens in addition to itself are material files.
class RecordingFiles : public Assimp::DefaultIOSystem {
 public:
  RecordingFiles(std::string part, std::vector<std::string>& missing) : part_(std::move(part)), missing_(missing) {}

  Assimp::IOStream* Open(const char* name, const char* mode) override {
    std::error_code error;
    if (!std::filesystem::is_regular_file(name, error)) {
      missing_.emplace_back(name);
      return nullptr;
    }
    if (name != part_ && lower_case_ending(part_) == ".obj") check_mtl(name);
    note_input(name);
    return DefaultIOSystem::Open(name, mode);
  }

 private:
  std::string part_;
  std::vector<std::string>& missing_;
};

void check_size(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  if (error) fail_at({.file = file.string()}, "cannot be read: " + error.message());
  if (bytes > kMaxBytes) {
    fail_at({.file = file.string()}, "has " + std::to_string(bytes) + " bytes, expected at most 1 GiB");
  }
}

// Checks for errors that Assimp would accept, repair or crash on.
void check_before_assimp(const std::filesystem::path& file, const std::string& ending) {
  check_size(file);
  if (ending == ".ply") check_ply(file);
  if (ending == ".stl") check_stl(file);
}

std::string on_one_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, ' ');
  return text;
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

void AssimpFile::fail(const std::string& message) const { fail_at({.file = file.string()}, message); }

void AssimpFile::warn(const std::string& message) {
  const std::string text = file.string() + ": " + message;
  if (std::ranges::find(warnings, text) == warnings.end()) warnings.push_back(text);
}

AssimpFile read_assimp_file(const std::filesystem::path& file, bool ignore_up_axis) {
  const std::string ending = lower_case_ending(file);
  check_before_assimp(file, ending);
  AssimpFile read{
      .file = file, .is_collada = ending == ".dae", .importer = std::make_unique<Assimp::Importer>(), .warnings = {}};
  std::vector<std::string> missing;
  read.importer->SetIOHandler(new RecordingFiles(file.string(), missing));  // the importer deletes it
  read.importer->SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
  read.importer->SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, ignore_up_axis);
  // Assimp's post-processing steps are off: its triangulation of a polygon has overlaps, and its vertex merging also
  // merges vertices that are only near each other.
  constexpr unsigned kNoSteps = 0;
  if (read.is_collada) {
    const XmlText text = XmlText::read(file);
    check_collada(text);
    const ColladaShapes shapes = collada_shapes(text);
    if (shapes.had_animations) read.warn("animations are not played; the rest pose is imported");
    if (shapes.had_skins) read.warn("skins are not animated; skinned meshes are imported in their rest pose");
    read.scene = read.importer->ReadFileFromMemory(shapes.xml.data(), shapes.xml.size(), kNoSteps, "dae");
  } else {
    read.scene = read.importer->ReadFile(file.string(), kNoSteps);
  }
  read.importer->SetIOHandler(nullptr);
  throw_if_memory_ran_out(*read.importer);
  if (read.scene == nullptr) read.fail(on_one_line(read.importer->GetErrorString()));
  for (const std::string& name : missing) read.warn("there is no material file " + in_quotes(name));
  if (read.scene->mRootNode == nullptr) read.fail("holds nothing to draw");
  check_indices(read);
  return read;
}

}  // namespace simvis
