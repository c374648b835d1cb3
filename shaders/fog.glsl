// Fog. Koschmieder, Theorie der horizontalen Sichtweite (1924): on the way to the eye, light is attenuated by
// exp(-extinction * distance), and the air adds the attenuated share of its own radiance.
layout(constant_id = SIMVIS_FOG) const bool kFog = false;

vec3 in_fog(vec3 radiance, float distance_m) {
  const float transmittance = exp(-view.airlight.w * distance_m);
  return radiance * transmittance + view.airlight.rgb * (1.0 - transmittance);
}
