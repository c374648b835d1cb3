// The effect `shadows`: what stands in a light's way keeps it from what lies behind. Lights have it that say
// shadows="yes".
//
//   <element type="light" name="SUN" insert_at="ROOT" elevation="35" shadows="yes" shadow_resolution="2048"/>
//
// Method   shadow maps: the depth of what each light meets first, drawn in one pass before the pictures. A point light
//          has the six sides of a cube in the world's axes; a spot one pinhole view around its cone, or that cube where
//          the cone is wider than 60 degrees to a side; a directional light a parallel view for each view of colour. It
//          holds what that view sees and all that stands before it on the way of the light. Its texels are a power of
//          two times shadow_resolution wide and lie on a lattice that is fixed in the world: edges stand still while
//          the camera moves, but for steps where the view's content grows or shrinks to another power.
// Accuracy what is lit is decided at the centre of a texel: an edge of a shadow is off by at most half a texel along
//          each axis of the map, as seen from the light. Nothing is smoothed. A shadow begins behind its caster where
//          the light has gone farther than the caster's own plane is deep within a texel. Surfaces do not shade
//          themselves: see shaders/shadows.glsl.
// Casters  what a depth camera or a laser scanner meets: masked texels by their mask, blended ones from half cover on,
//          triangles by both faces. Lines and points cast none, nor does what is nearer to a lamp than kLampRadius_m.
// Cost     nothing where no view of colour is due, or none that the light reaches.
#pragma once

#include <simvis/draw_list.h>
#include <simvis/frame_plan.h>
#include <simvis/target_limits.h>

namespace simvis {

/// What a point or spot light is made of: nearer than that nothing stands in its way, metres.
inline constexpr double kLampRadius_m = 1e-3;

/// Adds the shadow maps that the plan's views of colour need, and to those views which they use.
/// Throws InputError where they are larger than the device's targets, or more lights than SIMVIS_MAX_SHADOWS cast some.
void plan_shadows(const DrawList& list, const TargetLimits& limits, FramePlan& plan);

}  // namespace simvis
