// Replaces inventor_importer.cpp in a build without Coin.
#include <simvis/error.h>
#include "import/inventor/inventor_importer.h"

namespace simvis {

PartContent import_inventor(const ImportRequest& request, ContentPool&, std::chrono::milliseconds) {
  throw InputError(request.file.string() +
                   ": error: this build has no Coin, which reads Inventor and VRML; install libcoin-dev and build "
                   "SimVis again");
}

namespace {

PartContent import_part(const ImportRequest& request, ContentPool& pool) { return import_inventor(request, pool); }

const PartImporterRegistration inventor_registration({".iv", ".wrl"}, import_part);

}  // namespace
}  // namespace simvis
