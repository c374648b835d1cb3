// Converts the lights of Inventor, VRML 1.0 and VRML97 to SimVis's units.
#pragma once

#include <Inventor/VRMLnodes/SoVRMLLight.h>
#include <Inventor/actions/SoCallbackAction.h>
#include <Inventor/nodes/SoLight.h>

#include "import/sandbox/imported_scene.h"

namespace simvis {

/// Adds the light if it is on and SimVis supports its kind.
void add_inventor_light(SoCallbackAction& action, const SoLight& light, ImportedScene& scene);
void add_inventor_light(SoCallbackAction& action, const SoVRMLLight& light, ImportedScene& scene);

}  // namespace simvis
