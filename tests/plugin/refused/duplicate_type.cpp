// A plug-in with a type of its own and one whose name SimVis uses: the whole plug-in is refused.
#include <simvis/element.h>

#include <memory>

namespace simvis {
namespace {

class Nothing : public Element {
 public:
  void update(ParameterView) override {}
};

std::unique_ptr<Element> create(const ElementContext&) { return std::make_unique<Nothing>(); }

const ElementRegistration kOwn({.name = "own_type", .summary = "does nothing", .attributes = {}, .create = create});
const ElementRegistration kTaken({.name = "pose", .summary = "does nothing", .attributes = {}, .create = create});

}  // namespace
}  // namespace simvis
