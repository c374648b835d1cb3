#include "import/programs/collada/collada_archive.h"

#include <strings.h>

#include <pugixml.hpp>
#include <string_view>
#include <utility>

#include <simvis/location.h>
#include "import/mesh/percent_encoding.h"
#include "import/mesh/stb_picture.h"

namespace simvis {
namespace {

// What a reference in one file of an archive names: "./a/../b%20c.png" in "models/x.dae" is "models/b c.png".
std::string entry_of(std::string reference, const std::filesystem::path& from) {
  constexpr std::string_view kFileScheme = "file://";
  if (reference.starts_with(kFileScheme)) reference.erase(0, kFileScheme.size());
  const std::filesystem::path path = decode_percent(reference).value_or(reference);
  return (from.parent_path() / path.relative_path()).lexically_normal().generic_string();
}

std::string document_of(const ZipArchive& archive) {
  constexpr const char* kManifest = "manifest.xml";
  if (archive.contains(kManifest)) {
    const Bytes text = archive.read(kManifest);
    pugi::xml_document manifest;
    manifest.load_buffer(text.data(), text.size());
    std::string root = manifest.child("dae_root").text().as_string();
    root.resize(root.find('#') == std::string::npos ? root.size() : root.find('#'));
    if (!root.empty()) return entry_of(root, kManifest);
  }
  for (const std::string& name : archive.names()) {
    if (::strcasecmp(std::filesystem::path(name).extension().c_str(), ".dae") == 0) return name;
  }
  return "";
}

}  // namespace

ColladaArchive::ColladaArchive(const std::filesystem::path& file, Bytes bytes)
    : archive_(file, std::move(bytes)), file_(file.string()), document_(document_of(archive_)) {
  if (document_.empty()) fail_at({.file = file_}, "holds no .dae, and no manifest.xml that names one");
  if (!archive_.contains(document_)) {
    fail_at({.file = file_}, "does not hold " + in_quotes(document_) + ", which its manifest.xml names");
  }
}

Texture ColladaArchive::picture(const std::string& name) const {
  const std::string entry = entry_of(name, document_);
  if (!archive_.contains(entry)) fail_at({.file = file_}, "does not hold the picture " + in_quotes(entry));
  return decode_with_stb(archive_.read(entry), file_ + ": error: picture " + in_quotes(entry));
}

}  // namespace simvis
