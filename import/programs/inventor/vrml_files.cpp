#include "import/programs/inventor/vrml_files.h"

#include <Inventor/SbName.h>
#include <Inventor/lists/SoFieldList.h>
#include <Inventor/nodes/SoNode.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include <simvis/error.h>
#include <simvis/location.h>
#include "import/programs/inventor/vrml_text.h"

namespace simvis {
namespace {

using FieldNames = std::optional<std::set<std::string, std::less<>>>;

// Of the first of the names that Coin has.
FieldNames fields_of_any(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
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

// Coin's nodes of VRML97 have names that begin with VRML; a file may also have those of Inventor.
FieldNames fields_of_vrml97(const std::string& node) { return fields_of_any({"VRML" + node, node}); }

// A node of VRML 1 may declare its own fields.
FieldNames fields_of_vrml1(const std::string& node) {
  FieldNames fields = fields_of_any({node});
  if (fields) fields->insert({"fields", "isA"});
  return fields;
}

}  // namespace

// The main file has the name that the user gave; Coin has made it absolute.
std::string VrmlFiles::shown(const std::filesystem::path& file) const {
  return file == std::filesystem::absolute(main_) ? main_.string() : file.string();
}

std::optional<std::string> VrmlFiles::text_of(const std::filesystem::path& file, std::string_view text) try {
  check_vrml(text, shown(file));
  std::optional<VrmlText> made =
      readable_vrml(text, file, shown(file), text.starts_with("#VRML V1") ? fields_of_vrml1 : fields_of_vrml97);
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
