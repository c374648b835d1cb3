// Draw lists of earlier frames as a part of saved states.
#pragma once

#include <simvis/draw_list.h>
#include <simvis/state_archive.h>

namespace simvis {

/// Writes or reads what rays meet: the items of a list with their places, meshes and materials. A list that is read has
/// a log and no more than that: no lights, sky or air, and materials without what only colour shows. Meshes and
/// textures that StateArchive::graph() has anyway are numbers; the others, such as meshes of animations and of parts
/// that are gone, are written as a whole, and Gaussian splats, which no ray meets, are left out.
void archive_surfaces(StateArchive& state, DrawList& list);

}  // namespace simvis
