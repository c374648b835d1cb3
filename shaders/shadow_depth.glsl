// The depth that a shadow map stores for a fragment: the greatest distance from the light that the triangle's plane has
// within the texel. Depth is affine in the map, so its derivatives are exact; 0 is infinitely far. See shadows.glsl.
float shadow_depth() { return max(gl_FragCoord.z - 0.5 * fwidth(gl_FragCoord.z), 0.0); }
