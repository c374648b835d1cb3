// Opens the files that Assimp reads.
#pragma once

#include <assimp/DefaultIOSystem.h>

#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "import/programs/assimp_file.h"

namespace simvis {

/// Opens regular files only and warns of missing ones, because Assimp skips a missing material file without a message.
/// Assimp takes a failing read for the end of the file, so such a read is kept; see rethrow_fault().
/// All files that an OBJ file opens in addition to itself are material files, which are prepared where Assimp would
/// misread them. `file` must outlive this object.
class AssimpInput : public Assimp::DefaultIOSystem {
 public:
  explicit AssimpInput(AssimpFile& file);

  bool Exists(const char* name) const override;
  Assimp::IOStream* Open(const char* name, const char* mode) override;

  /// Throws the first exception of a read or an open.
  void rethrow_fault() const;

 private:
  const std::optional<std::string>& material_file(const char* name);

  AssimpFile& file_;
  bool is_obj_ = false;
  mutable std::exception_ptr fault_;
  std::map<std::string, std::optional<std::string>> material_files_;  // what Assimp reads in place of them
};

/// The file name extension in lower case, with its dot.
std::string lower_case_ending(const std::filesystem::path& file);

}  // namespace simvis
