#include "import/mesh/picture_search.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "engine/base/read_error.h"
#include "engine/base/read_fence.h"
#include "import/mesh/name_case.h"
#include "import/mesh/percent_encoding.h"

namespace simvis {
namespace {

namespace fs = std::filesystem;

// A folder that is searched, and the name below it.
struct Candidate {
  fs::path folder, name;
  bool elsewhere = false;
};

bool has_drive(std::string_view name) {
  return name.size() > 1 && name[1] == ':' && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
}

std::vector<Candidate> candidates_of(std::string name, const fs::path& part_file) {
  std::ranges::replace(name, '\\', '/');
  if (name.starts_with("file://")) name.erase(0, 7);
  // file:///C:/...
  if (name.starts_with('/') && has_drive(std::string_view(name).substr(1))) name.erase(0, 1);
  const fs::path folder = part_file.parent_path(), path(name), last = path.filename();
  std::vector<Candidate> candidates;
  const auto add = [&](const fs::path& written) {
    if (!has_drive(name)) candidates.push_back({written.is_absolute() ? fs::path() : folder, written});
  };
  add(path);
  // Names of COLLADA and VRML are URIs, but many exporters write them as they are.
  const std::optional<std::string> decoded = decode_percent(name);
  if (decoded && *decoded != name && decoded->find('\0') == std::string::npos) add(*decoded);
  if (last.empty() || last == "." || last == "..") return candidates;
  candidates.push_back({folder / ".." / "materials" / "textures", last});
  candidates.push_back({folder, last, true});
  return candidates;
}

}  // namespace

std::string PictureSearch::not_found() const {
  std::string text = "is not there; the material's colour replaces it; tried ";
  for (std::size_t i = 0; i < tried.size(); ++i) text += (i == 0 ? "" : ", ") + tried[i];
  return text;
}

PictureSearch find_picture(const std::string& name, const fs::path& part_file) {
  const std::vector<Candidate> candidates = candidates_of(name, part_file);
  PictureSearch search;
  for (const Candidate& candidate : candidates) {
    const fs::path file = candidate.folder / candidate.name;
    const bool may_be_read = is_readable(file);
    if (may_be_read && is_input_file(file)) {
      search.file = file;
      search.elsewhere = candidate.elsewhere;
      return search;
    }
    const std::string tried = file.string() + (may_be_read ? "" : " (outside the folders of the part: not read)");
    if (std::ranges::find(search.tried, tried) == search.tried.end()) search.tried.push_back(tried);
  }
  search.elsewhere = true;
  for (const Candidate& candidate : candidates) {
    search.file = file_ignoring_case(candidate.folder, candidate.name);
    if (search.file && !is_readable(*search.file)) search.file.reset();
    if (search.file) break;
  }
  return search;
}

}  // namespace simvis
