// What `simvis-run --describe all --xsd` prints: a schema by which editors complete and check scene files.
#pragma once

#include <string>

namespace simvis {

/// Returns the scene language with all registered types, those of plug-ins too, as XML Schema 1.0.
///
/// The schema accepts what the reader of scenes accepts, if the root element is <simvis> or one command. It cannot
/// state which attributes belong to which type, because XML Schema 1.0 has no rule that depends on the value of an
/// attribute: an element or a sensor may carry the attributes of all types of its kind, and the documentation of each
/// attribute lists its types.
std::string scene_schema();

}  // namespace simvis
