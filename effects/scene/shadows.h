// The effect `shadows`: objects block the light of lights with shadows="yes".
//
//   <element type="light" name="SUN" insert_at="ROOT" elevation="35" shadows="yes" shadow_resolution="2048"/>
//
// Method   Shadow maps: the depth of the first surface along each light ray, drawn in one pass before the pictures. A
//          point light has the six sides of a cube in the world's axes. A spot light has one pinhole view around its
//          cone, or the cube if the cone reaches more than 60 degrees to a side. A directional light has an
//          orthographic view for each colour view. This view holds what the colour view sees and everything in front of
//          that towards the light. The width of its texels is a power of two in metres divided by shadow_resolution,
//          and they lie on a lattice that is fixed in the world: shadow edges stand still while the camera moves,
//          except for steps where the extent of the view's content reaches another power of two.
// Accuracy The centre of a texel decides whether a point is lit: the edge of a shadow is off by at most half a texel
//          along each axis of the map, as seen from the light. Edges are not smoothed. A shadow begins behind its
//          caster at the distance along the light that the caster's own plane spans within a texel. Surfaces do not
//          shade themselves: see shaders/shadows.glsl.
// Casters  Shadow casters are what a depth camera or a laser scanner hits: masked texels by their mask, blended texels
//          with a coverage of one half or more, triangles with both faces. Lines and points cast no shadows, and
//          neither do objects nearer to a lamp than kLampRadius_m.
// Cost     There is no cost if no colour view is due, or if the light reaches none.
#pragma once

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>

namespace simvis {

/// Radius of a point or spot light in metres: nothing nearer than that blocks its light.
inline constexpr double kLampRadius_m = 1e-3;

/// Adds the shadow maps that the plan's colour views need, and records in each of those views which maps it uses.
/// Throws InputError if the maps are larger than the device's targets, or if more than SIMVIS_MAX_SHADOWS lights cast
/// shadows in one view.
void plan_shadows(const DrawList& list, const TargetLimits& limits, FramePlan& plan);

}  // namespace simvis
