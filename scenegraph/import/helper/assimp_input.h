// Opens the files that Assimp reads.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "scenegraph/import/helper/assimp_file.h"

namespace simvis {

/// Opens regular files only and warns of missing ones, because Assimp skips a missing material file without a message.
/// All files that an OBJ file opens in addition to itself are material files, which are prepared where Assimp would
/// misread them. `file` must outlive this object.
class AssimpInput : public Assimp::DefaultIOSystem {
 public:
  explicit AssimpInput(AssimpFile& file);

  Assimp::IOStream* Open(const char* name, const char* mode) override;

 private:
  const std::optional<std::string>& material_file(const char* name);

  AssimpFile& file_;
  bool is_obj_ = false;
  std::map<std::string, std::optional<std::string>> material_files_;  // what Assimp reads in place of them
};

/// The file name extension in lower case, with its dot.
std::string lower_case_ending(const std::filesystem::path& file);

}  // namespace simvis
