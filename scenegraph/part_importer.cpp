#include <simvis/part_importer.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "engine/base/assert.h"
#include "scenegraph/language/registrations.h"

namespace simvis {
namespace {

struct Importers {
  std::shared_mutex mutex;  // guards by_ending: a plug-in may be loaded while other threads read parts
  std::map<std::string, PartImporter> by_ending;
};

// A static variable of a function, so that it exists before the first registration of any other file.
Importers& importers() {
  static Importers all;
  return all;
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
  for (std::string& ending : endings) {
    std::string wrong = Registrations::check_version(built_for);
    {
      const std::lock_guard lock(importers().mutex);
      if (wrong.empty() && !importers().by_ending.emplace(ending, importer).second) {
        wrong = "another format already has this file extension";
      }
    }
    if (!wrong.empty()) {
      registrations.refuse("part format \"" + ending + "\": " + wrong);
      continue;
    }
    registrations.accept([ending = std::move(ending)] {
      const std::lock_guard lock(importers().mutex);
      importers().by_ending.erase(ending);
    });
  }
}

PartImporter find_part_importer(const std::filesystem::path& file) {
  const std::shared_lock lock(importers().mutex);
  const auto found = importers().by_ending.find(lower_case(file.extension().string()));
  return found == importers().by_ending.end() ? nullptr : found->second;
}

std::vector<std::string> known_part_endings() {
  const std::shared_lock lock(importers().mutex);
  std::vector<std::string> endings;
  for (const auto& [ending, importer] : importers().by_ending) endings.push_back(ending);
  return endings;
}

}  // namespace simvis
