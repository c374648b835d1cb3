// The sensor of every_output.h as a plug-in library.
#include "every_output.h"

namespace simvis {
namespace {

const SensorRegistration kRegistration(every_output::type());

}  // namespace
}  // namespace simvis
