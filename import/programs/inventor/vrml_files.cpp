#include "import/programs/inventor/vrml_files.h"

#include <Inventor/SbName.h>
#include <Inventor/lists/SoFieldList.h>
#include <Inventor/nodes/SoNode.h>

#include <algorithm>
#include <iterator>
#include <set>

#include <simvis/error.h>
#include <simvis/location.h>
#include "import/programs/inventor/vrml_text.h"

namespace simvis {
namespace {

// Coin's nodes of VRML97 have names that begin with VRML; a file may also have those of Inventor.
std::optional<std::set<std::string, std::less<>>> fields_of_coin(const std::string& node) {
  for (const std::string& name : {"VRML" + node, node}) {
    const SoType type = SoType::fromName(SbName(name.c_str()));
    if (type.isBad() || !type.isDerivedFrom(SoNode::getClassTypeId()) || !type.canCreateInstance()) continue;
    auto* const instance = static_cast<SoNode*>(type.createInstance());
    instance->ref();
    SoFieldList list;
    instance->getFields(list);
    std::set<std::string, std::less<>> fields;
    for (int i = 0; i < list.getLength(); ++i) {
      SbName field;
      if (instance->getFieldName(list[i], field)) fields.emplace(field.getString());
    }
    instance->unref();
    return fields;
  }
  return std::nullopt;
}

}  // namespace

// The main file has the name that the user gave; Coin has made it absolute.
std::string VrmlFiles::shown(const std::filesystem::path& file) const {
  return file == std::filesystem::absolute(main_) ? main_.string() : file.string();
}

std::optional<std::string> VrmlFiles::text_of(const std::filesystem::path& file, std::string_view text) try {
  std::optional<VrmlText> made = readable_vrml(text, file, shown(file), fields_of_coin);
  if (!made) return std::nullopt;
  std::ranges::move(made->warnings, std::back_inserter(warnings_));
  return std::move(made->text);
} catch (const InputError&) {
  if (!fault_) fault_ = std::current_exception();
  return std::nullopt;
}

void VrmlFiles::refuse_circle(const std::vector<std::filesystem::path>& chain) {
  std::string text;
  for (const std::filesystem::path& file : chain) text += (text.empty() ? "" : ", ") + shown(file);
  if (!fault_) {
    fault_ = std::make_exception_ptr(InputError(
        main_.string() + ": error: files include each other in a circle: " + text + ", " + shown(chain.front())));
  }
}

void VrmlFiles::rethrow_fault() const {
  if (fault_) std::rethrow_exception(fault_);
}

}  // namespace simvis
