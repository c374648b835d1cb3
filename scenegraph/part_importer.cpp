#include <simvis/part_importer.h>

#include <algorithm>
#include <map>

#include "engine/base/assert.h"
#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

// A function's static, so that it exists before the first registration of any other file.
std::map<std::string, PartImporter>& importers() {
  static std::map<std::string, PartImporter> map;
  return map;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

}  // namespace

PartImporterRegistration::PartImporterRegistration(std::vector<std::string> endings, PartImporter importer,
                                                   std::string_view built_for) {
  SIMVIS_ASSERT(importer != nullptr);
  Registrations& registrations = Registrations::instance();
  for (const std::string& ending : endings) {
    std::string wrong = Registrations::check_version(built_for);
    if (wrong.empty() && importers().contains(ending)) wrong = "another format has this ending already";
    if (!wrong.empty()) {
      registrations.refuse("part format \"" + ending + "\": " + wrong);
      continue;
    }
    importers().emplace(ending, importer);
    registrations.accept([ending] { importers().erase(ending); });
  }
}

PartImporter find_part_importer(const std::filesystem::path& file) {
  const auto found = importers().find(lower_case(file.extension().string()));
  return found == importers().end() ? nullptr : found->second;
}

std::vector<std::string> known_part_endings() {
  std::vector<std::string> endings;
  for (const auto& [ending, importer] : importers()) endings.push_back(ending);
  return endings;
}

}  // namespace simvis
