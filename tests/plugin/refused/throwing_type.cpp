// A plug-in whose types cannot be created: one constructor throws an exception other than simvis::Error, the other
// returns nothing.
#include <simvis/element.h>

#include <memory>
#include <stdexcept>

namespace simvis {
namespace {

std::unique_ptr<Element> fail(const ElementContext&) { throw std::out_of_range("index 7 of 3"); }
std::unique_ptr<Element> nothing(const ElementContext&) { return nullptr; }

const ElementRegistration kThrowing({.name = "throwing", .summary = "throws", .attributes = {}, .create = fail});
const ElementRegistration kEmpty({.name = "empty", .summary = "returns nothing", .attributes = {}, .create = nothing});

}  // namespace
}  // namespace simvis
