#include "scenegraph/picture_reader.h"

#include "engine/base/assert.h"

namespace simvis {
namespace {

PictureReader& registered_reader() {
  static PictureReader reader;
  return reader;
}

}  // namespace

PictureReaderRegistration::PictureReaderRegistration(const PictureReader& reader) { registered_reader() = reader; }

const PictureReader& picture_reader() {
  SIMVIS_ASSERT(registered_reader().texture != nullptr);
  return registered_reader();
}

}  // namespace simvis
