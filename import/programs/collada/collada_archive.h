// COLLADA that is packed with its pictures in a zip archive (.zae).
#pragma once

#include <filesystem>
#include <string>

#include <simvis/mesh.h>
#include "engine/base/input_file.h"
#include "import/mesh/zip_archive.h"

namespace simvis {

/// The document of an archive and the pictures beside it.
class ColladaArchive {
 public:
  /// Throws InputError naming `file`: it is no archive, or holds no document.
  ColladaArchive(const std::filesystem::path& file, Bytes bytes);

  /// The document that <dae_root> of manifest.xml names (COLLADA 1.5, chapter 3), or else the first .dae.
  Bytes document() const { return archive_.read(document_); }

  /// A picture that the document names. Throws InputError naming the archive: it is not there, or cannot be read.
  Texture picture(const std::string& name) const;

 private:
  ZipArchive archive_;
  std::string file_, document_;
};

}  // namespace simvis
