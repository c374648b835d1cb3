#include "effects/camera/rolling_shutter.h"

namespace simvis {

namespace {

constexpr AttributeSpec kRollingShutterAttributes[] = {
    {.name = "row_time",
     .default_value = "0",
     .unit = "s",
     .text = "time from one row to the next; 0: all rows at once",
     .min = 0,
     .max = 1},
    {.name = "rows_per_pose",
     .kind = AttributeKind::integer,
     .default_value = "8",
     .text = "rows that share a pose, that of the middle row; 1 is exact",
     .min = 1,
     .max = 16384},
};

std::unique_ptr<CameraEffect> create_rolling_shutter(const CameraEffectContext& context) {
  const double row_time_s = context.attributes.number("row_time");
  if (row_time_s == 0) return nullptr;
  return std::make_unique<RollingShutter>(row_time_s,
                                          static_cast<std::uint32_t>(context.attributes.integer("rows_per_pose")));
}

const CameraEffectRegistration kRollingShutterRegistration(
    {.type = {.name = "rolling_shutter",
              .summary = "Rows that are exposed one after the other while the camera and the world move.",
              .notes =
                  "The last row is exposed at the time of the frame. The camera and all objects move "
                  "along their joints between the last measurement and this one. Lights and shadows are those of the "
                  "time of the frame.",
              .source = "attribute row_time above 0",
              .outputs = kShownInColor | kShownInDepth,
              .knob = "rows_per_pose",
              .reference = "each row from the camera's pose at its time; Meingast, Geyer, Sastry, Geometric models of "
                           "rolling-shutter cameras, OMNIVIS 2005",
              .needs = kHasPixelRays,
              .attributes = kRollingShutterAttributes},
     .order = CameraOrder::shutter,
     .create = create_rolling_shutter});

}  // namespace

void RollingShutter::configure_rays(CameraLayout& layout) const {
  layout.row_time_s = row_time_s_;
  layout.rows_per_pose = rows_per_pose_;
}

}  // namespace simvis
