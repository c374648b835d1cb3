// A plug-in that was compiled with the headers of another version.
#include <simvis/element.h>

#include <memory>

namespace simvis {
namespace {

class Nothing : public Element {
 public:
  void update(ParameterView) override {}
};

std::unique_ptr<Element> create(const ElementContext&) { return std::make_unique<Nothing>(); }

const ElementRegistration kOld({.name = "old_type", .summary = "does nothing", .attributes = {}, .create = create},
                               "0.0.9");

}  // namespace
}  // namespace simvis
